"""Minimises a function with `optimize ask-tell`: python3 examples/ask_tell.py [OPTIMIZE]."""
import json, subprocess, sys

program = subprocess.Popen([*(sys.argv[1:2] or ["optimize"]), "ask-tell"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
assert program.stdin and program.stdout
to, of, best = program.stdin, program.stdout, None
def say(line: object): print(json.dumps(line), file=to, flush=True)
def hear(): return json.loads(of.readline())
say({"parameters": [{"name": "x", "low": -5, "high": 5}, {"name": "y", "low": -5, "high": 5}],
     "optimizer": "cma-es", "seed": 1, "direction": "minimize"})
for _ in range(60):
    say({"ask": 6})
    points = hear()["asked"]
    say({"tell": [{"id": p["id"], "value": (p["values"]["x"] - 1) ** 2 + (p["values"]["y"] + 2) ** 2} for p in points]})
    best = hear()["best"]
print(best)
