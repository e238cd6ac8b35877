"""Daylight: the sun's position, and weather files. Scene.set_sky sets sky and sun of a scene."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from . import _abi, _arrays, _params
from ._handle import call
from .types import SunPosition, WeatherReport

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .context import Context

_NUMBERS = ("hour", "dew_point", "direct_normal", "diffuse_horizontal")
_NUMBERS += ("direct_normal_illuminance", "diffuse_horizontal_illuminance")

_DATE = [("year", "i4"), ("month", "u4"), ("day", "u4"), ("reserved", "u4")]
#: The entry of each hour of Weather.hours. Values that the file does not have are NaN.
HOUR = np.dtype([*_DATE, *((name, "f8") for name in _NUMBERS)])


def sun_position(context: Context, time: datetime, latitude: float, longitude: float) -> SunPosition:
    """The position of the sun at a time, which must have a time zone; latitude and longitude in degrees, positive to
    the north and to the east. The result has altitude and azimuth in radians, and the distance in astronomical units.

    >>> from datetime import datetime, timedelta, timezone
    >>> noon = datetime(2026, 6, 21, 12, 30, tzinfo=timezone(timedelta(hours=2)))
    >>> sun = sun_position(context, noon, 48.14, 11.58)
    >>> print(f"{np.degrees(sun.altitude):.1f} {np.degrees(sun.azimuth):.1f}")
    63.7 155.9
    """
    if time.tzinfo is None:
        raise ValueError(f"the time {time} has no time zone; give it one, such as timezone.utc")
    utc = time.astimezone(timezone.utc)
    hour = utc.hour + utc.minute / 60 + (utc.second + utc.microsecond / 1e6) / 3600
    return _sun(context, year=utc.year, month=utc.month, day=utc.day, hour=hour, latitude=latitude, longitude=longitude)


def _sun(context: Context, **values: Any) -> SunPosition:
    params = _params.fill(_abi.luxfer_sun_params, values, [])
    position = _abi.luxfer_sun_position()
    call(context, "luxfer_sun_get_position", context, params, position, ctypes.sizeof(position))
    return cast(SunPosition, _params.report(position))


@dataclass(frozen=True)
class Weather:
    """The hours of a weather file of EnergyPlus (EPW), and its place."""

    #: The place: latitude and longitude in degrees, time_zone in hours, elevation in metres.
    place: WeatherReport
    #: A structured array with the fields of HOUR: the date, the middle of the hour in universal time, and the light.
    hours: NDArray[Any]

    @classmethod
    def read(cls, context: Context, path: str | os.PathLike[str]) -> Weather:
        """Reads an .epw file."""
        name = _params.text(os.fspath(path), "path")
        report = _abi.luxfer_weather_report()
        size = ctypes.sizeof(report)
        call(context, "luxfer_weather_read", context, name, 0, 0, None, 0, report, size)
        hours = np.empty(report.hours, HOUR)
        place = _arrays.pointer(hours, _abi.luxfer_weather_hour)
        call(context, "luxfer_weather_read", context, name, 0, len(hours), place, 0, report, size)
        return cls(cast(WeatherReport, _params.report(report)), hours)

    def sky(self, context: Context, index: int) -> dict[str, Any]:
        """The settings of Scene.set_sky for an hour: the sky of Perez et al. with the sun in the middle of the hour.

        >>> scene.set_sky(**weather.sky(context, 3421))  # doctest: +SKIP
        """
        hour, place = self.hours[index], self.place
        date = {name: int(hour[name]) for name in ("year", "month", "day")}
        sun = _sun(context, **date, hour=float(hour["hour"]), latitude=place.latitude, longitude=place.longitude)
        light = {name: float(hour[name]) for name in ("direct_normal", "diffuse_horizontal")}
        dew_point = {} if np.isnan(hour["dew_point"]) else {"dew_point": float(hour["dew_point"])}
        position = {"sun_altitude": sun.altitude, "sun_azimuth": sun.azimuth, "sun_distance": sun.distance}
        return {"model": "perez", "unit": "watts", **position, **light, **dew_point}
