"""Minimise a function through `optimize ask-tell`: python3 examples/ask_tell.py [OPTIMIZE]."""
import json, subprocess, sys

program = subprocess.Popen([*(sys.argv[1:2] or ["optimize"]), "ask-tell"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
say = lambda line: print(json.dumps(line), file=program.stdin, flush=True)
hear = lambda: json.loads(program.stdout.readline())
say({"parameters": [{"name": "x", "low": -5, "high": 5}, {"name": "y", "low": -5, "high": 5}],
     "optimizer": "cma-es", "seed": 1, "direction": "minimize"})
for _ in range(60):
    say({"ask": 6})
    points = hear()["asked"]
    say({"tell": [{"id": p["id"], "value": (p["values"]["x"] - 1) ** 2 + (p["values"]["y"] + 2) ** 2} for p in points]})
    told = hear()
print(told["best"])
