"""Run `python -m higvf_interfaces.poses SOURCE --corners X,Y X,Y X,Y X,Y --out FLOOR.yaml`."""

import sys

from higvf_interfaces.poses.making import main

sys.exit(main())
