"""Writes docs/foxglove_layout.json: `make proto`.

The settings of panels are of foxglove-sdk's types; how they are arranged is written as Foxglove exports a
layout, which it and its relatives import from a file.
"""

from __future__ import annotations

import json
from typing import Any, Literal, NamedTuple

import foxglove.layouts as fl

from aircraft.path import Phase
from recordings.schema import (
    BODY_FRAME,
    EVENTS,
    GUIDANCE,
    MAP_FRAME,
    OUTCOME,
    PLAN,
    PLAN_PATH,
    POSE,
    POSITION,
    STATE,
    TRUTH_GRID,
    Topic,
)

BLUE, YELLOW, RED, GREY = "#4e98e2ff", "#f5d547ff", "#e2574cff", "#9aa0a6ff"
PHASE_COLOURS = {Phase.LEAD_IN: GREY, Phase.LEG: BLUE, Phase.TURN: YELLOW, Phase.LOITER: RED}
FAR_M = 1e7
GRATICULE_KM = 4000


class View(NamedTuple):
    """From where a scene is seen: `tilt_deg` from straight above, `turn_deg` is 0 where the eye looks along
    the frame's y axis and 90 where it looks along x.

    `plan`: as a line, or as an arrow at each waypoint, since Foxglove draws no line that is more than
    100 km away.
    """

    frame: str
    follow: Literal["follow-pose", "follow-none"]
    distance_m: float
    tilt_deg: float
    turn_deg: float
    plan: Literal["arrow", "line"]


AREA = View(MAP_FRAME, "follow-none", 1.5e6, 35.0, 0.0, "arrow")
BEHIND = View(BODY_FRAME, "follow-pose", 3000.0, 65.0, 75.0, "line")


def plot(label: str, *series: tuple[str, str, str]) -> fl.PlotPanel:
    paths = [
        fl.PlotSeries(value=path, label=name, color=colour, enabled=True, timestamp_method="receiveTime")
        for path, name, colour in series
    ]
    config = fl.PlotConfig(
        paths=paths,
        is_synced=True,
        x_axis_val="timestamp",
        y_axis_label=label,
        show_legend=True,
        legend_display="left",
        sidebar_dimension=110,
        show_x_axis_labels=True,
        show_y_axis_labels=True,
    )
    return fl.PlotPanel(title=label, config=config)


def map_panel() -> fl.MapPanel:
    return fl.MapPanel(
        title="Position and plan",
        config=fl.MapConfig(
            follow_topic=POSITION.name,
            layer="map",
            zoom_level=6,
            topic_colors={POSITION.name: YELLOW, PLAN.name: BLUE},
            topic_config={
                POSITION.name: fl.MapTopicSettings(
                    history_mode="previous", point_display_mode="dot", show_heading=True
                )
            },
        ),
    )


def graticule() -> fl.BaseRendererGridLayerSettings:
    return fl.BaseRendererGridLayerSettings(
        instance_id="graticule",
        label="100 km",
        visible=True,
        frame_id=MAP_FRAME,
        size=GRATICULE_KM * 1000.0,
        divisions=GRATICULE_KM // 100,
        line_width=1.0,
        color="#ffffff30",
        position=(0.0, 0.0, 0.0),
        rotation=(0.0, 0.0, 0.0),
        order=1,
    )


def scene(title: str, view: View) -> fl.ThreeDeePanel:
    """The same things, in sizes that are seen from the view's distance."""
    unit_m = view.distance_m / 100.0
    return fl.ThreeDeePanel(
        title=title,
        config=fl.ThreeDeeConfig(
            fixed_frame=MAP_FRAME,
            follow_tf=view.frame,
            follow_mode=view.follow,
            camera_state=fl.ThreeDeeCameraState(
                distance=view.distance_m,
                perspective=True,
                phi=view.tilt_deg,
                theta_offset=view.turn_deg,
                target_offset=(0.0, 0.0, 0.0),
                fovy=45.0,
                near=view.distance_m / 100.0,
                far=FAR_M,
            ),
            scene=fl.BaseRendererSceneSettings(
                transforms=fl.BaseRendererTransforms(
                    show_label=True, label_size=2.0 * unit_m, axis_size=4.0 * unit_m, line_width=0.0
                )
            ),
            layers={"graticule": graticule()},
            topics={
                TRUTH_GRID.name: fl.BaseRendererGridTopicSettings(
                    visible=True,
                    color_mode="gradient",
                    color_field="hazard",
                    gradient=("#00000000", "#e2574cb0"),
                    min_value=0.0,
                    max_value=1.0,
                    interpolation_method="nearestNeighbor",
                    draw_behind=True,
                ),
                PLAN_PATH.name: fl.BaseRendererPosesTopicSettings(
                    visible=True,
                    type=view.plan,
                    line_width=0.5 * unit_m,
                    arrow_scale=(unit_m, 0.25 * unit_m, 0.25 * unit_m),
                    gradient=(BLUE, BLUE),
                ),
                POSE.name: fl.BaseRendererPoseTopicSettings(
                    visible=True,
                    type="arrow",
                    arrow_scale=(6.0 * unit_m, 1.5 * unit_m, 1.5 * unit_m),
                    color=YELLOW,
                ),
            },
        ),
    )


def phases() -> fl.StateTransitionsPanel:
    names = {phase: phase.name.lower().replace("_", "-") for phase in PHASE_COLOURS}
    named = ", ".join(f"{phase.value} {name}" for phase, name in names.items())
    states = [
        fl.StateTransitionsDiscreteCustomState(value=str(phase.value), label=name, color=PHASE_COLOURS[phase])
        for phase, name in names.items()
    ]
    series = fl.StateTransitionsSeries(
        value=f"{GUIDANCE.name}.phase",
        label="phase",
        enabled=True,
        timestamp_method="receiveTime",
        custom_states=fl.StateTransitionsDiscreteCustomStates(states=states),
    )
    return fl.StateTransitionsPanel(
        title=f"Phase: {named}", config=fl.StateTransitionsConfig(paths=[series], is_synced=True)
    )


def raw(title: str, topic: Topic) -> fl.RawMessagesPanel:
    return fl.RawMessagesPanel(
        title=title, config=fl.RawMessagesConfig(topic_path=topic.name, diff_enabled=False)
    )


PANELS: dict[str, Any] = {
    "map!position": map_panel(),
    "3D!area": scene("From above", AREA),
    "3D!behind": scene("From behind", BEHIND),
    "Plot!height": plot(
        "altitude, m",
        (f"{STATE.name}.altitude_m", "flown", YELLOW),
        (f"{GUIDANCE.name}.command_altitude_m", "commanded", BLUE),
    ),
    "Plot!speed": plot(
        "airspeed, m/s",
        (f"{STATE.name}.airspeed_mps", "flown", YELLOW),
        (f"{GUIDANCE.name}.command_airspeed_mps", "commanded", BLUE),
    ),
    "Plot!wind": plot(
        "wind toward, m/s",
        (f"{STATE.name}.wind_north_mps", "north", BLUE),
        (f"{STATE.name}.wind_east_mps", "east", RED),
    ),
    "Plot!errors": plot(
        "errors, m and s",
        (f"{GUIDANCE.name}.cross_track_m", "cross-track", YELLOW),
        (f"{GUIDANCE.name}.altitude_error_m", "altitude", BLUE),
        (f"{GUIDANCE.name}.time_error_s", "time", RED),
    ),
    "StateTransitions!phase": phases(),
    "RosOut!events": fl.LogPanel(
        title="Events", config=fl.LogConfig(topic_to_render=EVENTS.name, min_log_level=1)
    ),
    "RawMessages!state": raw("State", STATE),
    "RawMessages!outcome": raw("Outcome", OUTCOME),
}

TABS = {
    "Tab!scenes": ("3D!area", "3D!behind"),
    "Tab!told": ("RosOut!events", "RawMessages!state", "RawMessages!outcome"),
}


def split(direction: str, first: Any, second: Any, share: float) -> dict[str, Any]:
    return {"first": first, "second": second, "direction": direction, "splitPercentage": share}


def tabs(names: tuple[str, ...]) -> dict[str, Any]:
    return {"activeTabIdx": 0, "tabs": [{"title": PANELS[name].title, "layout": name} for name in names]}


def layout() -> dict[str, Any]:
    plots = split(
        "column",
        split("column", "Plot!height", "Plot!speed", 50),
        split("column", "Plot!wind", "Plot!errors", 50),
        50,
    )
    panels = {
        name: json.loads(panel.config.to_json()) | {"foxglovePanelTitle": panel.title}
        for name, panel in PANELS.items()
    }
    return {
        "configById": panels | {name: tabs(held) for name, held in TABS.items()},
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 60},
        "layout": split(
            "row",
            split("column", "map!position", "Tab!scenes", 40),
            split("column", plots, split("column", "StateTransitions!phase", "Tab!told", 35), 68),
            55,
        ),
    }


if __name__ == "__main__":
    print(json.dumps(layout(), indent=1))
