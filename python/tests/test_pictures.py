"""Pictures, tables of notebooks, and plots."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import matplotlib
import matplotlib.mathtext
import matplotlib.pyplot
import numpy as np
import pytest

import jointplay as jp
from jointplay._base import identifiers, latex_number, latex_text

matplotlib.use("Agg")


def test_a_picture_is_shown_and_saved_in_three_formats(tmp_path):
    rods = jp.Mechanism.from_catalogue("gpr-mechanism")
    tilted = rods.relieve({"rod 1": 0.003, "rod 2": 0.0, "rod 3": 0.0})
    picture = rods.draw(tilted, exaggerate=500.0, title="play")
    assert ET.fromstring(picture._repr_svg_()).get("width") == "720"
    assert ">play</text>" in picture.svg
    assert picture == rods.draw({"rod 1": 0.003, "rod 2": 0.0, "rod 3": 0.0}, exaggerate=500.0, title="play")
    for ending, magic in (("svg", b"<svg"), ("png", b"\x89PNG"), ("pdf", b"%PDF")):
        path = tmp_path / f"picture.{ending}"
        picture.save(path)
        picture.save(path)
        assert path.read_bytes().startswith(magic)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["picture.pdf", "picture.png", "picture.svg"]
    with pytest.raises(jp.InputError, match="must end in"):
        picture.save(tmp_path / "picture.jpg")


def test_labels_font_and_size_of_a_picture():
    four_bar = jp.Mechanism.from_catalogue("four-bar")
    links = four_bar.draw(labels="links").svg
    assert ">coupler</text>" in links and ">A</text>" not in links
    own = four_bar.draw(labels={"A": "motor", "B": ""}).svg
    assert ">motor</text>" in own and ">A</text>" not in own and ">B</text>" not in own and ">C</text>" in own
    large = four_bar.draw(text_scale=1.5, font="serif", width_px=360.0).svg
    root = ET.fromstring(large)
    assert root.get("width") == "360" and root.get("viewBox").startswith("0 0 240 ")
    assert root.get("font-family").startswith("serif, ")


def test_latex_sets_the_text_of_a_picture(tmp_path):
    picture = jp.Mechanism.from_catalogue("four-bar").draw(labels={"A": r"$\theta_1$"}, title="50 %")
    picture.save(tmp_path / "loop.tex")
    source = (tmp_path / "loop.tex").read_text(encoding="utf-8")
    assert r"{$\theta_1$}" in source and r"{50 \%}" in source and "{loop.pdf}" in source
    graphics = (tmp_path / "loop.pdf").read_bytes()
    assert graphics.startswith(b"%PDF") and b"DejaVu" not in graphics
    again, pdf = picture.latex("loop.pdf")
    assert again == source and len(pdf) == len(graphics)
    for label in re.findall(r"\\makebox\[0pt\]\[[lcr]\]\{(.*)\}\}%", source):
        matplotlib.mathtext.MathTextParser("path").parse(label.replace(r"\%", "%"))


def test_columns_of_data_frames_are_identifiers():
    rods = jp.Mechanism.from_catalogue("gpr-mechanism")
    motion = rods.drive({"rod 1": 0.002}, steps=3)
    frame = motion.to_dataframe()
    assert all(name.isidentifier() for name in frame.columns)
    assert "S1_0_rad" in frame.columns and "S1[0]_rad" in motion.columns()
    assert len(frame.query("rod_1_m > 0.001")) == 2
    assert (frame.rod_1_m == motion.columns()["rod 1_m"]).all()
    ax = motion.plot("rod_1_m", x="S1_0_rad")
    assert ax.get_ylabel() == "rod 1_m"
    matplotlib.pyplot.close(ax.figure)
    assert identifiers(["a b", "a_b", "a[b]", "1", "class", "x²", "plain"]) == [
        "a_b",
        "a_b_2",
        "a_b_3",
        "_1",
        "_class",
        "x",
        "plain",
    ]


def test_what_cannot_be_drawn_is_refused():
    four_bar = jp.Mechanism.from_catalogue("four-bar")
    assert four_bar.draw(ghost={"A": 0.3}).svg != four_bar.draw().svg
    assert four_bar.draw(four_bar.assemble().coordinates) == four_bar.draw()
    for options in (
        {"exaggerate": 0.5},
        {"view_rad": (0.0, 2.0)},
        {"at": np.zeros(3)},
        {"width_px": -1.0},
        {"at": {"Z": 1.0}},
        {"labels": "motors"},
        {"labels": {"Z": "motor"}},
        {"text_scale": 0.0},
        {"font": ";"},
        {"at": np.full(4, np.nan)},
    ):
        with pytest.raises((jp.InputError, jp.JointplayError)):
            four_bar.draw(**options)


def test_results_are_tables_in_notebooks():
    gpr = jp.Gpr.paper()
    tilts = np.linspace(0.0, 0.02, 50)
    many = gpr.forward(gpr.inverse(0.3, tilts).rods_m)
    html = many._repr_html_()
    root = ET.fromstring(html)
    assert root.find("caption").text == "ForwardMany, 50 rows"
    assert len(root.findall("tbody/tr")) == 21, "the first and last ten, and a gap"
    play = gpr.needed_clearance((0.5, 0.501, 0.502))
    assert ET.fromstring(play._repr_html_()).find("caption").text == "BallClearance"
    assert str(play).startswith("BallClearance\n  displacements_m")


def test_mobility_and_jacobian_are_formulas_for_papers():
    rods = jp.Mechanism.from_catalogue("gpr-mechanism")
    formula = rods.mobility()._repr_latex_()
    assert r"\text{instantaneous mobility} & 3 \\" in formula
    assert r"\text{finite mobility} & 1 \\" in formula
    jacobian = jp.Mechanism.from_catalogue("four-bar").jacobian("coupler", {"A": 0.4})
    lines = jacobian._repr_latex_().splitlines()
    assert lines[:2] == [r"$$\begin{array}{c|r}", r" & \text{A} \\"]
    cells = [line.removesuffix(r" \\").split(" & ") for line in lines[2:-1]]
    assert [name for name, _ in cells] == [r"\omega_x", r"\omega_y", r"\omega_z", "v_x", "v_y", "v_z"]
    shown = [float(value.replace(r" \cdot 10^{", "e").replace("}", "")) for _, value in cells]
    np.testing.assert_allclose(shown, jacobian.matrix[:, 0], rtol=6e-5)
    # Matplotlib typesets what is within the array: names and powers of ten are valid.
    for text in (latex_text("leg_1 50% #2"), rf"${latex_number(-1.25e-9)}$", rf"${latex_number(-0.0)}$"):
        matplotlib.mathtext.MathTextParser("path").parse(text if text[0] == "$" else f"${text}$")
    assert latex_number(-0.0) == "0"


def test_columns_are_plotted_into_axes_that_are_passed_in():
    motion = jp.Mechanism.from_catalogue("four-bar").drive({"A": 1.0})
    _, ax = matplotlib.pyplot.subplots()
    assert motion.plot("D_rad", x="A_rad", ax=ax) is ax
    line = ax.get_lines()[0]
    np.testing.assert_array_equal(line.get_ydata(), motion["D"])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("A_rad", "D_rad")
    assert len(motion.plot().get_lines()) == len(motion.columns())
    with pytest.raises(KeyError, match="A_rad"):
        motion.plot("E_rad")
    matplotlib.pyplot.close("all")
