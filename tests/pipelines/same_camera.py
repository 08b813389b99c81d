#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Whether a calibration is that of the truth: focal lengths and centre within some px.
#   same_camera.py FILE TRUTH PX
import json
import sys

found, truth = (json.load(open(path))["parameters"] for path in sys.argv[1:3])
apart = {name: found[name] - truth[name] for name in ("fx", "fy", "cx", "cy")}
print(apart)
sys.exit(any(abs(value) > float(sys.argv[3]) for value in apart.values()))
