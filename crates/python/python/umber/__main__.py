"""`python -m umber`: the command line."""

import sys

from umber.command_line import main

sys.exit(main())
