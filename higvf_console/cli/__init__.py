"""The command line: `higvf` and its subcommands."""
