"""Prints the CSV row of a study run without a budget, from its folder, its JSON and the landscape of its task."""

import csv
import json
import sys

folder, answer, landscape = sys.argv[1:]
with open(answer) as file:
    found = json.load(file)
with open(f"{folder}/walk.json") as file:
    designs = json.load(file)["designs"]
with open(f"{folder}/evaluations.csv") as file:
    trials = sum(int(row["trials"]) for row in csv.DictReader(file))
walked = [design["walked"] for design in designs if "walked" in design]
trials += sum(firm["trials"] for design in designs for firm in design["firm"])
# After an exhaustive search, only windows that changed were repeated.
for design in designs:
    if "walked" in design:
        repeated = [firm for firm in design["walked"]["firm"] if firm not in design["firm"]]
        trials += sum(task["trials"] for task in design["walked"]["tasks"]) + sum(f["trials"] for f in repeated)
with open(landscape) as file:
    best = max(float(row["firm_mm"]) for row in csv.DictReader(file) if row["firm_mm"])
firm = found["recommended"]["firm_range_mm"]
cells = [found["task"], found["seed"], found["evaluations"], len(designs), len(walked), trials, firm, best]
print(",".join(str(cell) for cell in cells))
