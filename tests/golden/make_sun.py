"""Writes sun.json: positions of the sun by the NREL SPA algorithm, from pvlib.

python3 -m venv venv && venv/bin/pip install pvlib && venv/bin/python make_sun.py
"""
import json
import pathlib

import pandas
import pvlib

CASES = [
    # latitude, longitude, time
    (52.52, 13.405, "2026-06-21T12:00:00+02:00"),
    (52.52, 13.405, "2026-06-21T05:00:00+02:00"),
    (52.52, 13.405, "2026-06-21T21:15:00+02:00"),
    (52.52, 13.405, "2026-12-21T12:00:00+01:00"),
    (52.52, 13.405, "2026-12-21T08:30:00+01:00"),
    (40.7128, -74.006, "2026-03-20T13:00:00-04:00"),
    (40.7128, -74.006, "2026-09-23T16:45:00-04:00"),
    (40.7128, -74.006, "2024-02-29T09:30:00-05:00"),
    (-33.8688, 151.2093, "2026-01-15T13:10:00+11:00"),
    (-33.8688, 151.2093, "2026-07-01T07:30:00+10:00"),
    (-33.8688, 151.2093, "2026-07-01T16:30:00+10:00"),
    (0.0, 0.0, "2026-03-20T12:00:00Z"),
    (0.0, 0.0, "2026-06-21T09:00:00Z"),
    (1.3521, 103.8198, "2026-11-03T13:00:00+08:00"),
    (64.1466, -21.9426, "2026-06-21T23:30:00Z"),
    (64.1466, -21.9426, "2026-12-21T13:30:00Z"),
    (69.6492, 18.9553, "2026-06-21T00:30:00+02:00"),
    (78.2232, 15.6267, "2026-04-20T03:00:00+02:00"),
    (-77.85, 166.6667, "2026-12-31T22:00:00+13:00"),
    (35.6762, 139.6503, "2026-08-08T11:45:00+09:00"),
    (19.4326, -99.1332, "2026-05-17T12:26:00-06:00"),
    (28.6139, 77.209, "2026-10-02T15:20:00+05:30"),
    (-54.8019, -68.303, "2026-02-14T18:00:00-03:00"),
    (51.4779, 0.0, "1905-05-01T10:00:00Z"),
    (51.4779, 0.0, "1950-10-10T14:00:00Z"),
    (51.4779, 0.0, "2000-01-01T12:00:00Z"),
    (51.4779, 0.0, "2095-08-15T17:30:00Z"),
    (52.52, 13.405, "2026-06-21T01:00:00+02:00"),
]

cases = []
for latitude, longitude, text in CASES:
    times = pandas.DatetimeIndex([pandas.Timestamp(text)])
    delta_t = None if times.year[0] < 2000 or times.year[0] > 2030 else 69.0
    found = pvlib.solarposition.spa_python(
        times, latitude, longitude, altitude=0, pressure=101000, temperature=10, delta_t=delta_t
    ).iloc[0]
    cases.append({
        "latitude": latitude,
        "longitude": longitude,
        "time": text,
        "julian_day": round(float(times.to_julian_date()[0]), 8),
        "elevation": round(float(found["apparent_elevation"]), 5),
        "azimuth": round(float(found["azimuth"]), 5),
        "distance_au": round(float(pvlib.solarposition.nrel_earthsun_distance(times).iloc[0]), 6),
    })

out = {
    "source": f"NREL SPA (Reda and Andreas 2003) in pvlib {pvlib.__version__}; 1010 hPa, 10 °C; angles in degrees, "
    "azimuth from north through east, elevation with refraction",
    "cases": cases,
}
path = pathlib.Path(__file__).with_name("sun.json")
path.write_text(json.dumps(out, indent=1, ensure_ascii=False) + "\n")
