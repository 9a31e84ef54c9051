"""Makes docs/flight.png from a recording: `python docs/picture.py [RECORDING] [HOURS SINCE DEPARTURE]`."""

import sys
from pathlib import Path

from PIL import Image  # comes with rerun-sdk

from recordings.rerun_replay import picture

OUT = Path(__file__).parent / "flight.png"
LIMIT_BYTES = 200_000


def main(recording: str = "runs/ian/flight.rrd", hours: str = "8") -> None:
    picture(Path(recording), OUT, at_s=3600.0 * float(hours))
    drawn = Image.open(OUT).convert("RGB")
    for colours in (256, 128, 64, 32):
        drawn.quantize(colours, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(OUT, optimize=True)
        if OUT.stat().st_size <= LIMIT_BYTES:
            break
    print(f"{OUT}: {OUT.stat().st_size / 1000.0:.0f} kB")


if __name__ == "__main__":
    main(*sys.argv[1:])
