"""The walkers on MuJoCo: the same boxes, densities, friction, motors, stops and open-loop commands, and the
same 1800 steps of 1/240 s. It prints one JSON line a body: microseconds a step and how far it got.

It compares rates, not trajectories: MuJoCo's contacts are soft where ours are stiff, so the distances only
show that the bodies really crawl, reach, hop and row (walker G-51, T-19)."""

import argparse
import json
import math
import time

import mujoco
import numpy as np
from mujoco import rollout

PHYSICS_HZ, CONTROL_HZ, SECONDS = 240, 60, 7.5
STEPS, HELD = int(PHYSICS_HZ * SECONDS), PHYSICS_HZ // CONTROL_HZ
GROUND, LIMB, TORSO = 0.9, 0.9, 0.3  # friction, combined by minimum (G-48)

# kind: (effort, N·m or N; full speed, rad/s or m/s), Table 2 of the paper in SI units (G-18)
MOTOR = {"hinge": (0.0784532, 10.0), "slide": (11.76798, 1.0), "ball": (0.0588399, 10.0)}
# The share of full speed by which a joint must lag for its motor to give full effort. Ours do at once; here a
# stiffer gain makes the simulation blow up at this step size, the runner's thin arms (1.2e-6 kg·m²) first.
LAG = {"hinge": 0.3, "slide": 0.3, "ball": 1.0}


def link(size, density, kind, axis, on_parent, on_child, stops=None):
    """One part of a limb and the joint that it hangs on; anchors of the limb at x > 0."""
    return dict(size=size, density=density, kind=kind, axis=axis, on_parent=on_parent, on_child=on_child, stops=stops)


X, DOWN = (1, 0, 0), (0, 0, -1)
ARM = (0.02, 0.09, 0.02)
BODIES = {  # torso's size and density, then one limb from the torso outwards (G-51)
    "crawler": ((0.12, 0.20, 0.05), 100, [
        link((0.02, 0.15, 0.02), 300, "hinge", X, (0.045, -0.10, 0), (0, 0.075, 0)),
    ]),
    "arm": ((0.12, 0.24, 0.04), 150, [
        link(ARM, 200, "hinge", X, (0.04, -0.09, 0.03), (0, 0.045, 0)),
        link(ARM, 200, "hinge", X, (0, -0.045, 0), (0, 0.045, 0), (-2 * math.pi / 3, 2 * math.pi / 3)),
        link((0.06, 0.06, 0.01), 200, "hinge", X, (0, -0.045, 0), (0, 0.03, 0), (-math.pi / 2, math.pi / 2)),
    ]),
    "hopper": ((0.12, 0.12, 0.06), 150, [
        link((0.03, 0.03, 0.08), 300, "hinge", X, (0.045, 0, -0.03), (0, 0, 0.04)),
        link((0.024, 0.06, 0.08), 300, "slide", DOWN, (0, 0, -0.04), (0, 0, 0), (0.0, 0.08)),
    ]),
    "runner": ((0.08, 0.16, 0.04), 100, [
        link((0.22, 0.02, 0.02), 200, "ball", X, (0.04, -0.04, 0.01), (-0.11, 0, 0)),
    ]),
}


def vector(values):
    return " ".join(f"{value:.12g}" for value in values)


def mirrored(values, side):
    return (values[0] * side, values[1], values[2])


def geom(size, density, friction, priority):
    # MuJoCo combines friction by maximum unless one geom has priority: the slippery torso's counts.
    return (f'<geom type="box" size="{vector(s / 2 for s in size)}" density="{density}" contype="1" '
            f'conaffinity="0" friction="{friction} 0 0" condim="3" priority="{priority}"/>')


def limb(links, side, depth, parent_anchor, actuators):
    """Nested bodies of one limb. A body's frame is its own centre, as in the specification."""
    if depth == len(links):
        return ""
    part = links[depth]
    name = f"{'left' if side < 0 else 'right'}{depth}"
    child = mirrored(part["on_child"], side)
    position = [a - b for a, b in zip(mirrored(part["on_parent"], side), child)]
    joint = f'<joint name="{name}" type="{part["kind"]}" pos="{vector(child)}"'
    if part["kind"] != "ball":
        joint += f' axis="{vector(part["axis"])}"'
    if part["stops"]:
        joint += f' limited="true" range="{vector(part["stops"])}"'
    effort, speed = MOTOR[part["kind"]]
    gain = effort / (LAG[part["kind"]] * speed)
    gears = [(1, 0, 0), (0, 1, 0), (0, 0, 1)] if part["kind"] == "ball" else [(1, 0, 0)]
    for gear in gears:
        actuators.append(f'<velocity jointinparent="{name}" gear="{vector(gear)} 0 0 0" kv="{gain:.12g}" '
                         f'forcelimited="true" forcerange="{-effort} {effort}"/>')
    return (f'<body pos="{vector(position)}">{joint}/>{geom(part["size"], part["density"], LIMB, 0)}'
            + limb(links, side, depth + 1, part, actuators) + "</body>")


def lowest(size, links):
    """The lowest point below the torso's centre in the start pose, m."""
    depth, centre = -size[2] / 2, 0.0
    for part in links:
        centre += part["on_parent"][2] - part["on_child"][2]
        depth = min(depth, centre - part["size"][2] / 2)
    return depth


def model(name, options):
    size, density, links = BODIES[name]
    actuators = []
    limbs = "".join(limb(links, side, 0, None, actuators) for side in (-1, 1))
    height = 0.001 - lowest(size, links)
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler angle="radian"/>
      <option timestep="{1 / PHYSICS_HZ}" gravity="0 0 -9.81" integrator="implicitfast" {options}/>
      <worldbody>
        <geom type="plane" size="200 200 1" contype="0" conaffinity="1" friction="{GROUND} 0 0" condim="3"/>
        <body name="torso" pos="0 0 {height}"><freejoint/>{geom(size, density, TORSO, 1)}{limbs}</body>
      </worldbody>
      <actuator>{"".join(actuators)}</actuator>
    </mujoco>""")


def commands(name, t):
    """T-19's open-loop commands at a time, one a degree of freedom, each within ±1."""
    def phase(frequency):
        return 2 * math.pi * frequency * t

    if name == "crawler":
        values = [1.0, 1.0]
    elif name == "arm":
        values = []
        for a in (phase(2.47), phase(2.47) + 3.14):
            values += [0.81 - 0.05 * math.sin(a), -0.18 * math.sin(a + 1.09), -0.45 * math.sin(a + 4.07)]
    elif name == "hopper":
        hip = -0.40 + 0.52 * math.sin(phase(3.26) + 4.27)
        slider = 1.0 if (3.26 * t) % 1.0 < 0.29 else -1.0
        values = [hip, slider] * 2
    else:
        a = phase(3.86)
        y, z = 0.6 * math.cos(a + 4.52) + 0.3, 0.73 * math.sin(a)
        values = [0.88, -y, -z, 0.88, y, z]
    return [max(-1.0, min(1.0, value)) for value in values]


def speeds(name):
    """Wanted joint speeds, (1800, degrees of freedom): commands held over a control step."""
    full = []
    for part in BODIES[name][2]:
        full += [MOTOR[part["kind"]][1]] * (3 if part["kind"] == "ball" else 1)
    held = [commands(name, k / CONTROL_HZ) for k in range(STEPS // HELD)]
    return np.repeat(np.array(held) * np.array(full * 2), HELD, axis=0)


def measure(name, options, repeats):
    m = model(name, options)
    control = speeds(name)
    data = mujoco.MjData(m)
    mujoco.mj_resetData(m, data)
    start = np.empty(mujoco.mj_stateSize(m, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(m, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    best_rollout = best_loop = math.inf
    for _ in range(repeats):
        # All 1800 steps in C, one call.
        before = time.perf_counter()
        states, _ = rollout.rollout(m, data, start[None, :], control[None, :, :])
        best_rollout = min(best_rollout, time.perf_counter() - before)
        # One call a control step, four steps in C each: what a controller in the loop would pay.
        mujoco.mj_resetData(m, data)
        held = control[::HELD]
        before = time.perf_counter()
        for row in held:
            data.ctrl[:] = row
            mujoco.mj_step(m, data, nstep=HELD)
        best_loop = min(best_loop, time.perf_counter() - before)
    advance = -data.body("torso").xipos[1]
    # A simulation that blows up is reset or ended early, and would look fast.
    assert not any(warning.number for warning in data.warning), f"{name} blew up"
    assert np.isfinite(states).all() and advance > 1.0, f"{name} went {advance} m: it must carry itself"
    return {
        "bench": "engine", "engine": f"mujoco {mujoco.__version__}", "body": name, "options": options,
        "us_per_step": round(1e6 * min(best_rollout, best_loop) / STEPS, 3),
        "us_per_step_rollout": round(1e6 * best_rollout / STEPS, 3),
        "us_per_step_loop": round(1e6 * best_loop / STEPS, 3),
        "steps": STEPS, "advance_m": round(float(advance), 3), "mass_kg": round(float(m.body_mass.sum()), 5),
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=15, help="the best of so many is reported")
    parser.add_argument("--options", default='solver="Newton"', help="attributes of MuJoCo's <option>")
    arguments = parser.parse_args()
    for body in BODIES:
        print(json.dumps(measure(body, arguments.options, arguments.repeats)), flush=True)
