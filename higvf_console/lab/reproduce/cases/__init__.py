"""The cases of the paper; each module runs some of them and compares the results with the paper."""
