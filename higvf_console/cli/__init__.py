"""The command line interface: `higvf` and its subcommands."""
