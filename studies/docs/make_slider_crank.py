#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the shipped slider-crank with and without play at its pin: docs/motion/slider_crank.png.

    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_slider_crank.py
"""
from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import statejump as sj
from statejump.core import figures

REPOSITORY = Path(__file__).resolve().parents[2]


def main() -> None:
    """Run both and draw."""
    play = sj.load("slider_crank").reduced(dynamic=True, progress=False)
    made = tomllib.loads((REPOSITORY / "cases" / "trusses" / "slider_crank.toml").read_text())
    clearance = made["revolute"][0]["radial_clearance_m"]
    del made["revolute"]
    made["node"] = [node for node in made["node"] if node["name"] != "J"]
    made["link"][1]["nodes"] = ["A", "P"]
    tight = sj.load(made).reduced(dynamic=True, progress=False)
    with figures.style():
        figure, places = figures.panels(3, 1, (8.0, 9.5), height_ratios=(1, 1, 1.6))
        for run, style, name in ((tight, "--", "without play"), (play, "-", "with play")):
            piston = run.names["nodes"].index("P")
            speed = run.history["velocity_m_per_s"].values[:, piston, 0]
            color = "#D55E00" if style == "--" else "#0072B2"
            for axes, values in ((places[0], speed), (places[1], run.history["drive_moment_N_m"].values[:, 0])):
                axes.plot(1e3 * run.time_s, values, style, color=color, linewidth=1.1, label=name)
        places[0].set_ylabel("Speed of the piston [m/s]")
        places[0].legend()
        places[1].set_ylabel("Moment of the drive [N m]")
        for axes in places[:2]:
            axes.set_xlabel("Time [ms]")
        off = 1e3 * play.history["eccentricity_m"].values[:, 0]
        around = np.linspace(0, 2 * np.pi, 200)
        places[2].plot(1e3 * clearance * np.cos(around), 1e3 * clearance * np.sin(around), "--", color="0.4",
                       linewidth=1, label="clearance")
        places[2].plot(off[:, 0], off[:, 1], color="#0072B2", linewidth=0.8,
                       label="centre of the journal in the bearing")
        places[2].set_aspect("equal")
        places[2].set_xlabel("along the piston's way [mm]")
        places[2].set_ylabel("across [mm]")
        places[2].legend(loc="upper center", bbox_to_anchor=(0.5, 0.82))
        figure.suptitle("Slider-crank at 5000 turns a minute, play of 0.5 mm at the piston pin")
        figure.savefig(REPOSITORY / "docs" / "motion" / "slider_crank.png", dpi=110)


if __name__ == "__main__":
    main()
