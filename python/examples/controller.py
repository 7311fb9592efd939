"""A neural network learns to turn a flexible arm to any angle within 1.2 s so that it does not swing afterwards.

The network gives the knots of the motor's torque for an angle that is asked for. The simulation is a layer: what the
tip does after the turn depends on the knots by exact derivatives. Needs PyTorch: `pip install torch`.
"""

from __future__ import annotations

import argparse
import math

import torch

import flexbody
from flexbody.torch import histories

KNOTS = 7
TURN, END = 1.2, 1.6  # The motor works until TURN; the tip is watched from there until END [s].

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--rounds", type=int, default=20, help="rounds of training")
rounds = parser.parse_args().rounds

# An aluminium strip of 1 m on a shoulder that a motor turns, in a horizontal plane. It swings with 2.5 Hz.
magnitude = {"table": {"times": [TURN * k / KNOTS for k in range(KNOTS + 1)], "values": [0.0] * (KNOTS + 1)}}
knot = "/loads/motor/torque/magnitude/table/values"
scene = {
    "version": 1,
    "name": "arm",
    "gravity": [0, 0, 0],
    "bodies": {
        "arm": {
            "beam": {
                "length": 1,
                "section": {"rectangle": {"width": 0.02, "height": 0.003}},
                "material": {"young": 7e10, "density": 2700},
                "frame": "clamped",
                "modes": {"bending_y": 2, "bending_z": 0, "torsion": 0, "stretch": 0},
                "strain": "linear",
                "shear": False,
                "damping": {"ratio": 0.01},
            }
        }
    },
    "joints": {"shoulder": {"revolute": {"between": ["arm", "ground"], "at": "arm.start", "axis": [0, 0, 1]}}},
    "loads": {
        "motor": {"torque": {"body": "arm", "point": "start", "direction": [0, 0, 1], "magnitude": magnitude}}
    },
    "simulation": {"duration": END, "steps": 160},
    "functions": {
        axis: {"final": {"position": {"body": "arm", "point": "end", "direction": direction}}}
        for axis, direction in {"x": [1, 0, 0], "y": [0, 1, 0]}.items()
    },
    "variables": {f"torque {k}": {"path": f"{knot}/{k}", "lower": -1, "upper": 1} for k in range(KNOTS)},
}
problem = flexbody.Problem.from_dict(scene)

# From here on: twenty lines.
torch.manual_seed(1)
tip = histories(problem, ["x", "y"], at=[TURN + (END - TURN) * k / 20 for k in range(21)])
network = torch.nn.Sequential(torch.nn.Linear(1, 8), torch.nn.Tanh(), torch.nn.Linear(8, KNOTS)).double()
optimizer = torch.optim.LBFGS(network.parameters(), max_iter=5, line_search_fn="strong_wolfe")


def miss(angles: torch.Tensor) -> torch.Tensor:
    """Mean squared distance of the tip from where it should rest [m²]."""
    path = tip(0.2 * network(angles[:, None]))
    goal = torch.stack([torch.cos(angles), torch.sin(angles)], dim=1)
    return ((path - goal[:, :, None]) ** 2).sum(dim=1).mean()


def closure() -> torch.Tensor:
    optimizer.zero_grad()
    loss = miss(torch.linspace(0.3, 1.5, 6, dtype=torch.float64))
    loss.backward()
    return loss


for step in range(rounds):
    print(f"round {step:3d}  loss {optimizer.step(closure).item():.3e}")

with torch.no_grad():
    for degrees in (20, 45, 80):
        distance = math.sqrt(miss(torch.tensor([math.radians(degrees)], dtype=torch.float64)).item())
        print(f"turn by {degrees} degrees: the tip misses by {1000 * distance:.1f} mm")
