"""One of JSBSim's own aircraft with an autopilot of ours: its XML is made when it is loaded, never kept."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from aircraft.errors import ModelError
from aircraft.mistakes import nearest


def write_with_autopilot(root: Path, base: str, autopilot: Path, into: Path) -> None:
    """Write `base`.xml: JSBSim's file with a reference to the autopilot's in place of any of its own.

    Args:
        root: the folder of JSBSim's data, with `aircraft/` in it.
        base: name of one of its aircraft.
        autopilot: file of an `<autopilot>` element.
        into: the folder to write to.

    Raises:
        ModelError: if JSBSim has no such aircraft.
    """
    source = root / "aircraft" / base / f"{base}.xml"
    if not source.is_file():
        known = sorted(path.name for path in (root / "aircraft").iterdir() if path.is_dir())
        raise ModelError(f"JSBSim has no aircraft {base!r}{nearest(base, known)}; see {root / 'aircraft'}")
    tree = ElementTree.parse(source)
    model = tree.getroot()
    for own in model.findall("autopilot"):
        model.remove(own)
    model.append(ElementTree.Element("autopilot", file=str(autopilot.resolve())))
    tree.write(into / f"{base}.xml", encoding="utf-8", xml_declaration=True)
