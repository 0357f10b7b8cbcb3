# SPDX-License-Identifier: Apache-2.0
"""From a recording to poses and a picture of the path, in Python.

    python3 plot.py CONFIG.yaml RECORDING.odo OUT.png
"""
import sys

import odograph

if len(sys.argv) != 4:
    sys.exit(__doc__)
config, recording, picture = sys.argv[1:]
run = odograph.run(config, recording)
print(run.poses["header"]["t_ns"][-1], run.poses["p_n"][-1])
odograph.plot(run).figure.savefig(picture)
