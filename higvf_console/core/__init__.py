"""The contracts that everything else stands on: state, commands, edits, interfaces, reports, parameters, errors."""
