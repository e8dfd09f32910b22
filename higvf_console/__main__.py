"""`python -m higvf_console` is `higvf`."""

import sys

from higvf_console.cli.main import main

sys.exit(main())
