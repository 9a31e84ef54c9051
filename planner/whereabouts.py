"""Places and areas for people: degrees north or south of the equator, east or west of Greenwich."""

from __future__ import annotations


def place_text(lat_deg: float, lon_deg: float, digits: int = 2) -> str:
    """A place, such as "27.56 N 83.30 W"; its longitude may be off by turns."""
    return f"{_latitude(lat_deg, digits)} {_longitude(lon_deg, digits)}"


def area_text(south_deg: float, north_deg: float, west_deg: float, east_deg: float) -> str:
    """An area from its south to its north edge, and eastward from its west edge, however they are counted.

    Across the date line it is "177.00 E to 176.00 W"; once around the Earth, "all longitudes".
    """
    rows = f"{_latitude(south_deg)} to {_latitude(north_deg)}"
    if east_deg - west_deg >= 360.0:
        return f"{rows}, all longitudes"
    return f"{rows}, {_longitude(west_deg)} to {_longitude(east_deg)}"


def _latitude(lat_deg: float, digits: int = 2) -> str:
    return _sided(lat_deg, "N", "S", digits)


def _longitude(lon_deg: float, digits: int = 2) -> str:
    if abs(lon_deg) > 180.0:
        lon_deg = (lon_deg + 180.0) % 360.0 - 180.0
    return _sided(lon_deg, "E", "W", digits)


def _sided(angle_deg: float, positive: str, negative: str, digits: int) -> str:
    """What is rounded to zero is on the positive side."""
    rounded_deg = round(angle_deg, digits)
    return f"{abs(rounded_deg):.{digits}f} {negative if rounded_deg < 0.0 else positive}"
