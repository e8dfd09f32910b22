"""The loop: a session with its clock, one run tick by tick, history, snapshots, recording, previews."""
