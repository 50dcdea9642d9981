"""ESP creatures on MuJoCo: the same parts, hinges, muscles and open-loop activations, neighbours colliding, and the
same 2400 steps of 1/240 s. It reads the bodies, one JSON line each, and prints one line a body: microseconds a
step of 1/60 s, and how far it got.

    cargo run --release -p creatures --example esp_steps -- bodies | python benches/peers/mujoco_esp.py

It compares rates, not trajectories: MuJoCo's contacts are soft where ours are stiff (ESP E-22, E-25)."""

import argparse
import json
import math
import sys
import time

import mujoco
import numpy as np
from mujoco import rollout

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


def measure(body, options, repeats):
    m = model(body, options)
    phases = STRIDES * np.arange(STEPS)[:, None] / HZ + 0.25 * np.arange(m.nu)[None, :]
    held = 0.5 + 0.5 * np.sin(2 * math.pi * phases)
    control = np.repeat(held, SUBSTEPS, axis=0)
    data = mujoco.MjData(m)
    start = np.empty(mujoco.mj_stateSize(m, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(m, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    best = math.inf
    for _ in range(repeats):
        before = time.perf_counter()
        states, _ = rollout.rollout(m, data, start[None, :], control[None, :, :])
        best = min(best, time.perf_counter() - before)
        # One call a step of the brain: what a controller in the loop would pay.
        mujoco.mj_resetData(m, data)
        before = time.perf_counter()
        for row in held:
            data.ctrl[:] = row
            mujoco.mj_step(m, data, nstep=SUBSTEPS)
        best = min(best, time.perf_counter() - before)
    # A simulation that blows up is reset or ended early, and would look fast.
    assert not any(warning.number for warning in data.warning), f"{body['name']} blew up"
    assert np.isfinite(states).all()
    return {
        "bench": "esp", "engine": f"mujoco {mujoco.__version__}", "body": body["name"], "options": options,
        "us_per_step": round(1e6 * best / STEPS, 2), "steps": STEPS,
        "way_m": round(float(np.linalg.norm(data.body(1).xipos[:2])), 3),
        "mass_kg": round(float(m.body_mass.sum()), 3),
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5, help="the best of so many is reported")
    parser.add_argument("--options", default='solver="Newton"', help="attributes of MuJoCo's <option>")
    arguments = parser.parse_args()
    for line in sys.stdin:
        print(json.dumps(measure(json.loads(line), arguments.options, arguments.repeats)), flush=True)
