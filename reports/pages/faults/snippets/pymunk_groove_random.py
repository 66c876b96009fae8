from importlib.metadata import version

from reports.pages.faults.experiments import CASES, Grooves

# Random grooves, in the ground and in a body, against an ideal one: velocities after a step, of the largest.
print(f"pymunk {version('pymunk')}")
for case in CASES:
    off = Grooves(case).run()["off"]
    print(f"{case:24}{len(off)} grooves, off by at most {off.max():.0e}")
