from dataclasses import replace

import pytest

from recordings.rerun_replay import picture
from recordings.rerun_text import drawable
from recordings.rerun_writer import RerunRecorder


@pytest.mark.parametrize(
    "text", ["goal: Zürich", "Łódź", "Αθήνα", "Архангельск", "× no route, 5 ≤ 7 °", "a\nb"]
)
def test_what_the_font_has_stays(text):
    assert drawable(text) == text


def test_what_it_lacks_becomes_a_question_mark():
    assert drawable("東京 tower ✈") == "?? tower ?"
    assert drawable("tab\there") == "tab?here"
    assert drawable("Zu\u0308rich") == "Zürich"  # composed first


@pytest.mark.usefixtures("vulkan")
def test_names_in_letters_that_the_viewer_lacks_do_not_end_it(workshop, tmp_path):
    header = workshop.header(workshop.straight)
    goals = tuple(replace(goal, name=f"{goal.name} 東京") for goal in header.plan.goals)
    plan = replace(header.plan, goal=goals[0].name, goals=goals)
    header = replace(header, scenario="嵐", plan=plan, limits=('never "嵐"',))
    path = tmp_path / "flight.rrd"
    workshop.fly(header, hz=1, until_s=100.0).record(RerunRecorder(path))
    picture(path, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
