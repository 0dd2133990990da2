"""Looks at answers from outside, the same way for every program."""

import numpy as np


def gpr(work, answers, least):
    """Gaps between sockets and balls, and how far virtual joints are from the least displacement."""
    heading = np.arctan2(work.direction[:, 1], work.direction[:, 0])
    gaps, apart = [], []
    for rods, answer, reference in zip(work.poses, answers, least):
        if not answer:
            continue
        rotation, point = np.array(answer[:9]).reshape(3, 3), np.array(answer[9:12])
        slid, turned = np.array(answer[12:15]), np.array(answer[15:18]) + heading
        sockets = np.column_stack([slid * np.cos(turned), slid * np.sin(turned), np.zeros(3)])
        gaps.append(float(np.abs(sockets @ rotation.T + point - work.balls(rods)).max()))
        apart.append(float(np.abs(np.array(answer[12:15]) - reference[12:15]).max()))
    return {
        "answered": len(gaps),
        "closed": sum(gap <= work.gap for gap in gaps),
        "largest_gap_m": max(gaps, default=None),
        "median_gap_m": float(np.median(gaps)) if gaps else None,
        "slides_from_least_m": max(apart, default=None),
    }


def linkage(work, answers):
    """Gaps of the loops: of points in metres, of directions in radians."""
    gaps = [float(np.abs(work.gaps(np.array(answer))).max()) for answer in answers if answer]
    return {
        "answered": len(gaps),
        "closed": sum(gap <= work.gap for gap in gaps),
        "largest_gap": max(gaps, default=None),
    }
