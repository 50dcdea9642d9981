"""Flyers on MuJoCo: the same capped cylinders, masses, hinges and ball joints, stops, torque limits and open-loop
strokes, and the same 1500 steps of 0.05 s. It prints one JSON line a size: microseconds a step of ours and of
MuJoCo's, and the ratio.

    python benches/peers/mujoco_flyers.py target/release/examples/flyer_rates

The two take turns, so that a busy moment of the machine falls on both. A life is the same every time, and the
fastest of its steps over all lives count (of ours, of stretches of 50 steps), since others leave no whole life alone;
a size's figure is the mean over its bodies.

It compares rates, not trajectories. MuJoCo has no films: its own model of a medium, which takes every body for a box
of its inertia, stands for the air, with the air's density and viscosity (`--medium none` leaves it out). Its motors
are soft velocity servos, where ours are exact rows."""

import argparse
import json
import math
import subprocess
import time

import mujoco
import numpy as np

DENSITY, VISCOSITY = 1.2, 1.81e-5  # of air at a scale of 1 (F-42)
# The share of full speed by which a joint must lag for its motor to give full torque. Ours do at once; here stiffer
# servos make the simulation blow up at this step size.
LAG = 3.0


def vector(values):
    return " ".join(f"{value:.12g}" for value in values)


def rotation(quaternion):
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array(quaternion))
    return matrix.reshape(3, 3)


def part(body, index, actuators):
    """A part with its children. A body's frame is its part's centre and axes."""
    this = body["parts"][index]
    hold = this["hold"]
    axes = rotation(this["quaternion"])
    if hold is None:
        place, turn, joint = this["centre"], this["quaternion"], "<freejoint/>"
    else:
        base = body["parts"][hold["parent"]]
        to_base = rotation(base["quaternion"]).T
        place = to_base @ (np.array(this["centre"]) - np.array(base["centre"]))
        inverse, turn = np.empty(4), np.empty(4)
        mujoco.mju_negQuat(inverse, np.array(base["quaternion"]))
        mujoco.mju_mulQuat(turn, inverse, np.array(this["quaternion"]))
        rate, stop = body["hinge" if hold["hinge"] else "ball"]
        anchor = (0.0, 0.0, -0.5 * this["length"])
        if hold["hinge"]:
            axis = axes.T @ to_base.T @ np.array(hold["hinge"])
            joint = (f'<joint name="j{index}" type="hinge" pos="{vector(anchor)}" axis="{vector(axis)}" '
                     f'limited="true" range="{-stop} {stop}"/>')
            gears = [(1, 0, 0)]
        else:
            joint = f'<joint name="j{index}" type="ball" pos="{vector(anchor)}" limited="true" range="0 {stop}"/>'
            gears = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
        for gear in gears:
            actuators.append(f'<velocity jointinparent="j{index}" gear="{vector(gear)} 0 0 0" '
                             f'kv="{hold["torque"] / (LAG * rate):.12g}" forcelimited="true" '
                             f'forcerange="{-hold["torque"]:.12g} {hold["torque"]:.12g}"/>')
    geom = (f'<geom type="capsule" size="{this["radius"]:.12g} {0.5 * this["length"]:.12g}" '
            f'density="{body["density"]}" contype="0" conaffinity="0"/>')
    children = "".join(part(body, child, actuators) for child, other in enumerate(body["parts"])
                       if other["hold"] and other["hold"]["parent"] == index)
    return f'<body pos="{vector(place)}" quat="{vector(turn)}">{joint}{geom}{children}</body>'


def model(body, options, medium):
    actuators = []
    tree = part(body, 0, actuators)
    air = ""
    if medium == "box":
        air = f'density="{DENSITY * body["alpha"]:.12g}" viscosity="{VISCOSITY * body["alpha"]:.12g}"'
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler angle="radian"/>
      <option timestep="{body["dt"]}" gravity="0 {-body["gravity"]} 0" integrator="implicitfast" {air} {options}/>
      <worldbody>{tree}</worldbody>
      <actuator>{"".join(actuators)}</actuator>
    </mujoco>""")


class Flyer:
    def __init__(self, body, options, medium):
        self.name, self.segments, self.steps = body["name"], body["segments"], body["steps"]
        self.model = model(body, options, medium)
        self.data = mujoco.MjData(self.model)
        phases = body["strokes"] * body["dt"] * np.arange(self.steps)[:, None] + 0.25 * np.arange(self.model.nu)
        rates = np.array([body["ball"][0]] * 3 + [body["hinge"][0]] * (self.model.nu - 3))
        self.control = rates * np.sin(2 * math.pi * phases)
        self.ours, self.whole, self.swing, self.swing_ours = math.inf, math.inf, 0.0, 0.0
        self.times = np.full(self.steps, math.inf)

    def fly(self):
        """One life. The first hinge's swing shows that the wings beat."""
        model, data, angles = self.model, self.data, []
        hinge = model.jnt_qposadr[2]  # behind the free joint and the wing-root's ball
        mujoco.mj_resetData(model, data)
        for step, row in enumerate(self.control):
            data.ctrl[:] = row
            before = time.perf_counter()
            mujoco.mj_step(model, data)
            self.times[step] = min(self.times[step], time.perf_counter() - before)
            angles.append(data.qpos[hinge])
        # A simulation that blows up is reset or ended early, and would look fast.
        assert not any(warning.number for warning in data.warning), f"{self.name} blew up"
        assert np.isfinite(data.qpos).all(), f"{self.name} is nowhere"
        self.swing = float(np.std(angles))

    @property
    def theirs(self):
        return 1e6 * self.times.mean()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ours", help="the built example flyer_rates")
    parser.add_argument("--passes", type=int, default=3, help="how often ours and MuJoCo's take turns")
    parser.add_argument("--lives", type=int, default=7, help="lives of each body in a pass, as many as of ours")
    parser.add_argument("--options", default='solver="Newton"', help="attributes of MuJoCo's <option>")
    parser.add_argument("--medium", choices=["box", "none"], default="box", help="MuJoCo's air")
    arguments = parser.parse_args()

    def lines(mode):
        output = subprocess.run([arguments.ours, mode], check=True, capture_output=True, text=True).stdout
        return [json.loads(line) for line in output.splitlines()]

    flyers = [Flyer(body, arguments.options, arguments.medium) for body in lines("bodies")]
    for _ in range(arguments.passes):
        for flyer, rate in zip(flyers, lines("once"), strict=True):
            assert flyer.name == rate["name"]
            flyer.ours, flyer.whole = min(flyer.ours, rate["open"]), min(flyer.whole, rate["whole"])
            flyer.swing_ours = rate["swing"]
        for _ in range(arguments.lives):
            for flyer in flyers:
                flyer.fly()
    for segments in sorted({flyer.segments for flyer in flyers}):
        of_size = [flyer for flyer in flyers if flyer.segments == segments]
        mean = {key: sum(getattr(flyer, key) for flyer in of_size) / len(of_size)
                for key in ("ours", "whole", "theirs", "swing", "swing_ours")}
        print(json.dumps({
            "bench": "flyers", "engine": f"mujoco {mujoco.__version__}", "medium": arguments.medium,
            "options": arguments.options, "segments": segments, "bodies": len(of_size),
            "us_per_step": round(mean["theirs"], 2), "ours_us_per_step": round(mean["ours"], 2),
            "ours_with_brain_us_per_step": round(mean["whole"], 2),
            "times_mujoco": round(mean["theirs"] / mean["ours"], 2),
            "times_mujoco_with_brain": round(mean["theirs"] / mean["whole"], 2),
            "swing_rad": round(mean["swing"], 3), "ours_swing_rad": round(mean["swing_ours"], 3),
        }), flush=True)
