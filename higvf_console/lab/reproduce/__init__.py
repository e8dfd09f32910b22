"""The paper's cases, run headless and reported beside the paper: `higvf reproduce`."""
