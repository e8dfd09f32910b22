"""Readers of recorded formats, found by what a file holds, never by its name alone: `reading` is the entrance."""
