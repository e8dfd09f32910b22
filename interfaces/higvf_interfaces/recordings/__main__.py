"""Run `python -m higvf_interfaces.recordings OUT_DIR --plan PLAN.yaml`."""

import sys

from higvf_interfaces.recordings.plan import main

sys.exit(main())
