"""Runs the cases of the paper headless and compares the results with the paper: `higvf reproduce`."""
