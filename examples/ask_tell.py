"""Minimises a function with `optimize ask-tell`: python3 examples/ask_tell.py [OPTIMIZE]."""
import json, subprocess, sys

program = subprocess.Popen([*(sys.argv[1:2] or ["optimize"]), "ask-tell"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
assert program.stdin and program.stdout
requests, replies, best = program.stdin, program.stdout, None
def send(line: object): print(json.dumps(line), file=requests, flush=True)
def receive(): return json.loads(replies.readline())
send({"parameters": [{"name": "x", "low": -5, "high": 5}, {"name": "y", "low": -5, "high": 5}],
     "optimizer": "cma-es", "seed": 1, "direction": "minimize"})
for _ in range(60):
    send({"ask": 6})
    points = receive()["asked"]
    send({"tell": [{"id": p["id"], "value": (p["values"]["x"] - 1) ** 2 + (p["values"]["y"] + 2) ** 2}
                   for p in points]})
    best = receive()["best"]
print(best)
