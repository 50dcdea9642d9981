"""ESP creatures on MuJoCo: the same parts, hinges, muscles and open-loop activations, neighbours colliding, and the
same 2400 steps of 1/240 s. It prints one JSON line a body: microseconds a step of 1/60 s of ours and of MuJoCo's,
the ratio, and how far MuJoCo's got.

    python benches/peers/mujoco_esp.py target/release/examples/esp_steps

The two take turns, so that a busy moment of the machine falls on both. A life is the same every time, and on either
side the fastest of each of its steps over all lives counts, since others leave no whole life alone. It compares rates, not trajectories: MuJoCo's contacts are soft where ours are stiff (ESP E-22,
E-25)."""

import argparse
import json
import math
import subprocess
import time

import mujoco
import numpy as np

SUBSTEPS, STEPS, HZ = 4, 600, 60
BETA, SLACK, LIMIT = 0.02, 0.5, 2.0  # of a muscle (E-25)
STRIDES = 1.5  # 1/s


def vector(values):
    return " ".join(f"{value:.12g}" for value in values)


def part(body, index):
    """A part with its children. A body's frame is its part's centre, and all parts are unturned in the rest pose."""
    this = body["parts"][index]
    joint = this["joint"]
    if joint is None:
        position, hinge = (0.0, 0.0, body["height"]), "<freejoint/>"
    else:
        position = [a - b for a, b in zip(joint["parent_anchor"], joint["child_anchor"])]
        hinge = f'<joint type="hinge" pos="{vector(joint["child_anchor"])}" axis="{vector(joint["axis"])}"/>'
    sites = "".join(
        f'<site name="m{m}e{end}" pos="{vector(muscle["ends"][end])}"/>'
        for m, muscle in enumerate(body["muscles"]) for end in (0, 1) if muscle["parts"][end] == index)
    children = "".join(part(body, child) for child, other in enumerate(body["parts"])
                       if other["joint"] and other["joint"]["parent"] == index)
    geom = f'<geom type="box" size="{vector(this["half"])}" density="1000" friction="0.8 0 0" condim="3"/>'
    return f'<body pos="{vector(position)}">{hinge}{geom}{sites}{children}</body>'


def model(body, options):
    tendons, actuators = "", ""
    for m, muscle in enumerate(body["muscles"]):
        slack = SLACK * muscle["rest_length"]
        stiffness = muscle["force_max"] / (muscle["rest_length"] - slack)
        gains = (stiffness * slack, -stiffness, -BETA * stiffness)
        tendons += f'<spatial name="t{m}"><site site="m{m}e0"/><site site="m{m}e1"/></spatial>'
        actuators += (f'<general tendon="t{m}" gaintype="affine" gainprm="{vector(gains)}" biastype="none" '
                      f'ctrllimited="true" ctrlrange="0 1" forcelimited="true" '
                      f'forcerange="{-LIMIT * muscle["force_max"]} 0"/>')
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler angle="radian"/>
      <option timestep="{1 / (HZ * SUBSTEPS)}" gravity="0 0 -9.81" integrator="implicitfast" {options}>
        <flag filterparent="disable"/>
      </option>
      <worldbody><geom type="plane" size="200 200 1" friction="0.8 0 0" condim="3"/>{part(body, 0)}</worldbody>
      <tendon>{tendons}</tendon>
      <actuator>{actuators}</actuator>
    </mujoco>""")


class Creature:
    def __init__(self, body, options):
        self.name, self.parts = body["name"], len(body["parts"])
        self.model = model(body, options)
        self.data = mujoco.MjData(self.model)
        phases = STRIDES * np.arange(STEPS)[:, None] / HZ + 0.25 * np.arange(self.model.nu)[None, :]
        self.held = 0.5 + 0.5 * np.sin(2 * math.pi * phases)
        self.theirs, self.ours = np.full(STEPS, math.inf), {}

    def live(self):
        """A life, one call a step of the brain, as a controller would pay."""
        mujoco.mj_resetData(self.model, self.data)
        for step, row in enumerate(self.held):
            self.data.ctrl[:] = row
            before = time.perf_counter()
            mujoco.mj_step(self.model, self.data, nstep=SUBSTEPS)
            self.theirs[step] = min(self.theirs[step], time.perf_counter() - before)
        # A simulation that blows up is reset or ended early, and would look fast.
        assert not any(warning.number for warning in self.data.warning), f"{self.name} blew up"
        assert np.isfinite(self.data.qpos).all(), f"{self.name} is nowhere"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ours", help="the built example esp_steps")
    parser.add_argument("--passes", type=int, default=4, help="how often ours and MuJoCo's take turns")
    parser.add_argument("--lives", type=int, default=5, help="lives of each body in a pass, as many as of ours")
    parser.add_argument("--options", default='solver="Newton"', help="attributes of MuJoCo's <option>")
    arguments = parser.parse_args()

    def lines(mode):
        output = subprocess.run([arguments.ours, mode], check=True, capture_output=True, text=True).stdout
        return [json.loads(line) for line in output.splitlines()]

    creatures = [Creature(body, arguments.options) for body in lines("bodies")]
    for _ in range(arguments.passes):
        for creature, rates in zip(creatures, lines("once"), strict=True):
            assert creature.name == rates.pop("name")
            creature.ours = {key: min(rate, creature.ours.get(key, math.inf)) for key, rate in rates.items()}
        for _ in range(arguments.lives):
            for creature in creatures:
                creature.live()
    for creature in creatures:
        ours, theirs = creature.ours, 1e6 * creature.theirs.mean()
        print(json.dumps({
            "bench": "esp", "engine": f"mujoco {mujoco.__version__}", "options": arguments.options,
            "body": creature.name, "parts": creature.parts, "us_per_step": round(theirs, 1),
            **{f"ours_{key}_us_per_step": round(rate, 1) for key, rate in ours.items()},
            "times_mujoco": round(theirs / ours["open"], 2),
            "times_mujoco_with_brain": round(theirs / ours["whole"], 2),
            "brain_share": round(ours["mind"] / ours["whole"], 3),
            "trials_per_second": round(1e6 / (ours["whole"] * STEPS), 1),
            "way_m": round(float(np.linalg.norm(creature.data.body(1).xipos[:2])), 3),
            "mass_kg": round(float(creature.model.body_mass.sum()), 3),
        }), flush=True)
