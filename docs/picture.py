"""Makes docs/flight.png from a recording: `python docs/picture.py [RECORDING] [HOURS SINCE DEPARTURE]`."""

import sys
from pathlib import Path

from PIL import Image  # comes with rerun-sdk

from recordings.rerun_replay import picture

OUT = Path(__file__).parent / "flight.png"


def main(recording: str = "runs/ian/flight.rrd", hours: str = "8") -> None:
    picture(Path(recording), OUT, at_s=3600.0 * float(hours))
    drawn = Image.open(OUT).convert("RGB")
    drawn.quantize(256, kmeans=2, dither=Image.Dither.NONE).save(OUT, optimize=True)
    print(f"{OUT}: {OUT.stat().st_size / 1000.0:.0f} kB")


if __name__ == "__main__":
    main(*sys.argv[1:])
