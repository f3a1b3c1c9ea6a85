# SPDX-License-Identifier: Apache-2.0
"""Files as other programs write them, each with one fault of one kind, and all of one known body.

The body has 2 N/(m/s^2), 2.5 Hz and a damping of 0.35; band noise shakes it for 60 s at 100 Hz.  MEMBERS is the table:
kind, name, how the file is made, what is right.  field_files_test.py runs it.
"""
import dataclasses
import datetime
import struct
import typing
import wave

import numpy

try:
    import h5py
except ImportError:
    h5py = None
try:
    import scipy.io
except ImportError:
    scipy = None

RATE_HZ = 100
ROWS = 6000
GAIN, NATURAL_HZ, DAMPING = 2.0, 2.5, 0.35
MAP = ["--map", "time=t [s]", "acc=a_y [m/s^2]", "force=f [N]"]
HEADER = "time,acc,force"


def body(frequency_hz):
    """Response of the body [N/(m/s^2)]."""
    ratio = numpy.asarray(frequency_hz) / NATURAL_HZ
    return GAIN / (1.0 - ratio**2 + 2j * DAMPING * ratio)


def draw(seed=5, rows=ROWS, rate_hz=RATE_HZ, highest_hz=8.0):
    """Times, band noise as acceleration, and the body's force with 0.3 % of noise."""
    random = numpy.random.default_rng(seed)
    lines = numpy.fft.rfft(random.standard_normal(rows))
    frequency_hz = numpy.fft.rfftfreq(rows, 1.0 / rate_hz)
    lines[(frequency_hz > highest_hz) | (frequency_hz < 0.3)] = 0.0
    lines *= rows / numpy.sqrt(2.0 * numpy.sum(numpy.abs(lines)**2))  # 1 m/s^2 RMS
    force = numpy.fft.irfft(body(frequency_hz) * lines, rows)
    force += 0.003 * numpy.std(force) * random.standard_normal(rows)
    return numpy.arange(rows) / rate_hz, numpy.fft.irfft(lines, rows), force


TIME, ACC, FORCE = draw()


# What is right of a file.

@dataclasses.dataclass
class Refused:
    """Status 2 and one line, with these words."""
    words: tuple


@dataclasses.dataclass
class Right:
    """The body within 1 % and 1 degree.  `said`: a finding (channel, what), or a word of the notes."""
    said: object = None


@dataclasses.dataclass
class Unusable:
    """Not usable, and no model to `diagnose`: an unsound finding (channel, what), or a word of the reason.

    `effects`: that `diagnose` may look for; what is small and slow it shows by an effect alone.
    """
    said: object
    effects: int = 0


@dataclasses.dataclass
class Assumed:
    """What one recording cannot show: the body times `factor`, and `assumed` says so."""
    said: str
    factor: float


@dataclasses.dataclass
class Member:
    kind: str   # of the table: A1 to A7, B8 to B13
    name: str
    make: typing.Callable  # of a folder; gives the path and the words behind it
    right: object
    needs: object = True   # None: its writer is not installed
    pasted: bool = False   # run again with the words of the refusal


MEMBERS = []


def member(kind, name, right, **more):
    """Adds what the function makes."""
    def add(make):
        MEMBERS.append(Member(kind, name, make, right, **more))
        return make
    return add


# Text

def text(folder, header=HEADER, columns=None, separator=",", decimal=".", end="\n", first=repr, tail="", above="",
         row_end="", encoding="utf-8", name="ride.csv"):
    columns = (TIME, ACC, FORCE) if columns is None else columns
    lines = [header] if header else []
    for row in zip(*(numpy.asarray(column).tolist() for column in columns)):
        cells = [first(row[0])] + [cell if isinstance(cell, str) else repr(cell).replace(".", decimal)
                                   for cell in row[1:]]
        lines.append(separator.join(cells) + row_end)
    path = folder / name
    path.write_bytes((above + end.join(lines) + end + tail).encode(encoding))
    return path


def table(kind, name, right, words=MAP, **form):
    """A text table."""
    more = {key: form.pop(key) for key in ("pasted",) if key in form}
    MEMBERS.append(Member(kind, name, lambda folder: (text(folder, **form), words), right, **more))


def spoilt(kind, name, right, acc=None, force=None, time=None, **form):
    """A table with one channel that a function has changed."""
    def changed(values, change):
        return values if change is None else change(values.copy())
    table(kind, name, right, columns=(changed(TIME, time), changed(ACC, acc), changed(FORCE, force)), **form)


def put(first, end, value):
    def change(x):
        x[first:end] = value
        return x
    return change


def held(rows):
    return lambda x: numpy.repeat(x[::rows], rows)[:len(x)]


def each(places, size):
    """`size`: added to those rows."""
    def change(x):
        x[places] += size
        return x
    return change


def fill(places, value):
    def change(x):
        x[places] = value
        return x
    return change


def stamp(t):
    return datetime.datetime(2026, 11, 26, 9, 59, 50) + datetime.timedelta(microseconds=round(1e6 * t))


FEW = numpy.random.default_rng(7).choice(numpy.arange(20, ROWS - 20), 12, replace=False)
SOME = numpy.random.default_rng(8).choice(numpy.arange(20, ROWS - 20), 120, replace=False)


# MCAP

VECTORS = "geometry_msgs/Vector3 {0}\ngeometry_msgs/Vector3 {1}\n" + "=" * 80 + \
          "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
HEADERS = "=" * 80 + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80 + \
          "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
TOPICS = {"/imu": ("geometry_msgs/msg/AccelStamped", "Accel", "accel", "linear", "angular"),
          "/stick": ("geometry_msgs/msg/WrenchStamped", "Wrench", "wrench", "force", "torque")}
BAG_MAP = ["--map", "/imu.accel.linear.y=a_y", "/stick.wrench.force.y=f"]


def record(code, *parts):
    content = b"".join(parts)
    return struct.pack("<BQ", code, len(content)) + content


def counted(content):
    content = content.encode() if isinstance(content, str) else content
    return struct.pack("<I", len(content)) + content


def vector_message(stamp_s, y, log_s=None):
    """A message of AccelStamped or WrenchStamped in CDR."""
    ns = round(stamp_s * 1e9)
    return struct.pack("<4BiIIc3x6d", 0, 1, 0, 0, ns // 10**9, ns % 10**9, 1, b"\0", 0.0, y, 0.0, 0.0, 0.0, 0.0)


def bag(folder, stamps=None, messages=None, logged=None):
    """MCAP of two topics without chunks (mcap.dev, "MCAP Format Specification").

    `stamps`: of each topic [s]; `logged`: its log times; `messages(topic, n, data)`: what is written of a message.
    """
    out = [b"\x89MCAP0\r\n", record(1, counted("ros2"), counted("other"))]
    for number, (topic, (kind, name, field, one, two)) in enumerate(TOPICS.items(), 1):
        definition = (f"std_msgs/Header header\ngeometry_msgs/{name} {field}\n" + HEADERS + "=" * 80 +
                      f"\nMSG: geometry_msgs/{name}\n" + VECTORS.format(one, two))
        out.append(record(3, struct.pack("<H", number), counted(kind), counted("ros2msg"), counted(definition)))
        out.append(record(4, struct.pack("<HH", number, number), counted(topic), counted("cdr"), counted(b"")))
    begin_s = 1.7e9
    for n in range(ROWS):
        for number, (topic, values) in enumerate((("/imu", ACC), ("/stick", FORCE)), 1):
            at_s = (stamps or {}).get(topic, TIME)[n]
            data = vector_message(begin_s + at_s, values[n])
            data = data if messages is None else messages(topic, n, data)
            log_ns = round((begin_s + (TIME if logged is None else logged)[n]) * 1e9)
            if data is not None:
                out.append(record(5, struct.pack("<HIQQ", number, n, log_ns, log_ns), data))
    out += [record(15, bytes(4)), record(2, bytes(20)), b"\x89MCAP0\r\n"]
    path = folder / "bag.mcap"
    path.write_bytes(b"".join(out))
    return path


def bagged(kind, name, right, **form):
    MEMBERS.append(Member(kind, name, lambda folder: (bag(folder, **form), BAG_MAP), right))


def stepping(*steps):
    """Times that step by so many seconds at that row."""
    time_s = TIME.copy()
    for row, by_s in steps:
        time_s[row:] += by_s
    return {"/imu": time_s, "/stick": time_s}


# HDF5 and MATLAB

def hdf5(kind, name, right, sets, words=MAP):
    """`sets`: of each name its values and its attributes."""
    def make(folder):
        path = folder / "ride.h5"
        with h5py.File(path, "w") as file:
            for title, (values, attributes) in sets.items():
                file[title] = values
                for key, value in attributes.items():
                    file[title].attrs[key] = value
        return path, words
    MEMBERS.append(Member(kind, name, make, right, needs=h5py))


def matlab(kind, name, right, variables, words=MAP):
    def make(folder):
        path = folder / "ride.mat"
        scipy.io.savemat(path, variables())
        return path, words
    MEMBERS.append(Member(kind, name, make, right, needs=scipy))


def sound(folder, rate_hz=RATE_HZ, width=2):
    counts = numpy.round(numpy.column_stack([ACC / 8.0, FORCE / 20.0]) * 32767).astype("<i2")
    path = folder / "logger.wav"
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(width)
        file.setframerate(rate_hz)
        file.writeframes(counts.tobytes())
    return path


SOUND_MAP = ["--map", "channel 1=a_y [m/s^2] * 8", "channel 2=f [N] * 20"]


def cut(path, share):
    whole = path.read_bytes()
    path.write_bytes(whole[:round(share * len(whole))])
    return path


# Good files

table("-", "as it is", Right())
table("-", "with titles that need no mapping", Right(), words=[], header="t [s],a_y [m/s^2],f [N]")
bagged("-", "MCAP of two topics", Right())

# A1. Time that goes back

bagged("A1", "both topics step back by 5 s", Right(("t", "time_goes_back")), stamps=stepping((3000, -5.0)))
bagged("A1", "by an hour", Right(("t", "time_goes_back")), stamps=stepping((3000, -3600.0)))
bagged("A1", "by 0.25 s", Right(("t", "time_goes_back")), stamps=stepping((3000, -0.25)))
bagged("A1", "twice", Right(("t", "time_goes_back")), stamps=stepping((2000, -5.0), (4500, -2.0)))
bagged("A1", "back, and forward again", Right(("t", "time_goes_back")), stamps=stepping((2000, -5.0), (4000, 5.0)))
bagged("A1", "one topic alone steps back", Refused(("/stick", "go back")),
       stamps={"/imu": stepping((3000, -5.0))["/imu"]})
bagged("A1", "one topic steps forward by 0.5 s", Unusable("leads"), stamps={"/imu": stepping((1000, 0.5))["/imu"]})
bagged("A1", "both step forward by 10 s", Right("gap"), stamps=stepping((3000, 10.0)))
bagged("A1", "stamps that stand still", Refused(("stamp",)), stamps={"/imu": 0 * TIME, "/stick": 0 * TIME})
spoilt("A1", "CSV, 5 s back", Refused(("time",)), time=lambda t: numpy.r_[t[:3000], t[3000:] - 5.0])
spoilt("A1", "CSV, a counter of 32 bits of us begins again", Refused(("time",)),
       time=lambda t: (t * 1e6 + 4.28e9) % 2**32, words=["--map", "time=t [us]", *MAP[2:]])
table("A1", "CSV, clock times over midnight", Refused(("time",)),
      first=lambda t: (stamp(t) + datetime.timedelta(hours=14)).time().isoformat())
hdf5("A1", "HDF5, an hour back", Refused(("time",)),
     {"time": (numpy.r_[TIME[:3000], TIME[3000:] - 3600.0], {}), "acc": (ACC, {}), "force": (FORCE, {})})

# A2. A model that explains nothing

spoilt("A2", "a rail of 32767 for 0.3 s", Right(("f", "rail")), force=put(3000, 3030, 32767.0))
spoilt("A2", "a rail of -32768 in the acceleration", Right(("a_y", "rail")), acc=put(3000, 3030, -32768.0))
spoilt("A2", "a rail for 0.3 s that ends the record", Right(("f", "rail")), force=put(5970, 6000, 32767.0))
spoilt("A2", "a frozen tail of 20 s", Right(("f", "stuck")), force=lambda x: numpy.r_[x[:4000], 0 * x[4000:] + x[4000]])
spoilt("A2", "a tail of zeros, 20 s, in the force", Right(("f", "stuck")), force=put(4000, 6000, 0.0))
spoilt("A2", "a tail of zeros in both", Right("stuck"), force=put(4000, 6000, 0.0), acc=put(4000, 6000, 0.0))
spoilt("A2", "a tail of zeros in both of 40 s", Unusable("stuck"), force=put(2000, 6000, 0.0), acc=put(2000, 6000, 0.0))
spoilt("A2", "zeros ahead of the record", Right(), force=put(0, 1000, 0.0), acc=put(0, 1000, 0.0))
spoilt("A2", "zeros in all columns of the tail, time too", Refused(("time",)), force=put(4000, 6000, 0.0),
       acc=put(4000, 6000, 0.0), time=put(4000, 6000, 0.0))
spoilt("A2", "force of another ride", Unusable("belong together"), force=lambda x: draw(99)[2])
spoilt("A2", "noise alone as force", Unusable("belong together"),
       force=lambda x: numpy.random.default_rng(3).standard_normal(ROWS))
spoilt("A2", "noise alone as acceleration", Unusable("belong together"),
       acc=lambda x: numpy.random.default_rng(3).standard_normal(ROWS))
spoilt("A2", "clocks 0.83 % apart", Unusable("clock"),
       force=lambda x: numpy.interp(TIME * 1.0083, TIME, x, right=x[-1]))
spoilt("A2", "clocks 0.1 % apart", Unusable("clock"), force=lambda x: numpy.interp(TIME * 1.001, TIME, x))
spoilt("A2", "the force lags by 2 s", Unusable("follows"), force=lambda x: numpy.roll(x, 200))
spoilt("A2", "the force leads by 0.3 s", Unusable("leads"), force=lambda x: numpy.roll(x, -30))
spoilt("A2", "the force leads by 0.05 s", Unusable("leads"), force=lambda x: numpy.roll(x, -5))
spoilt("A2", "force a thousand times too large", Unusable("unit"), force=lambda x: 1e3 * x)
spoilt("A2", "force a thousand times too small", Unusable("unit"), force=lambda x: 1e-3 * x)
spoilt("A2", "acceleration in mm/s^2 as m/s^2", Unusable("unit"), acc=lambda x: 1e3 * x)
spoilt("A2", "a machine of 2 t, which is stated", Assumed("units as the columns state", 1e3), force=lambda x: 1e3 * x,
       words=[*MAP, "--heaviest", "5000"])
spoilt("A2", "a machine of 2 t, of which 1 t is stated", Unusable("what was stated is"), force=lambda x: 1e3 * x,
       words=[*MAP, "--heaviest", "1000"])
spoilt("A2", "columns exchanged", Unusable("swap"), acc=lambda x: FORCE, force=lambda x: ACC)
spoilt("A2", "columns exchanged, the force in kN", Refused(("excitation",)), acc=lambda x: 1e-3 * FORCE,
       force=lambda x: ACC)
for name, change, said in (
        ("three times the gain in the second half", lambda x: numpy.r_[x[:3000], 3.0 * x[3000:]], "times the gain"),
        ("a fifth more gain in the second half", lambda x: numpy.r_[x[:3000], 1.2 * x[3000:]], "times the gain"),
        ("three times the gain for 10 s", lambda x: numpy.r_[x[:2000], 3.0 * x[2000:3000], x[3000:]], "times the gain"),
        ("a gain that drifts from 1 to 3", lambda x: x * numpy.linspace(1.0, 3.0, ROWS), "times the gain"),
        ("an offset of 20 N that steps in", lambda x: x + 20.0 * (TIME >= 30.0), "the mean of f"),
        ("an offset of 20 N for 10 s", lambda x: x + 20.0 * ((TIME >= 20.0) & (TIME < 30.0)), "the mean of f")):
    spoilt("A2", name, Unusable(said), force=change)
spoilt("A2", "an offset of 0.5 N that steps in", Unusable("the mean of f", effects=1),
       force=lambda x: x + 0.5 * (TIME >= 30.0))
spoilt("A2", "an offset that drifts to 10 N", Unusable("of the whole recording", effects=1),
       force=lambda x: x + TIME / 6.0)
spoilt("A2", "a third of the acceleration's gain in the first half", Unusable("times the gain"),
       acc=lambda x: numpy.r_[x[:3000] / 3.0, x[3000:]])
spoilt("A2", "an offset of the acceleration that steps in", Unusable("the mean of a_y"),
       acc=lambda x: x + (TIME >= 30.0))
spoilt("A2", "the force with the other sign", Assumed("the sign opposite to a_y", -1.0), force=lambda x: -x)
spoilt("A2", "the acceleration with the other sign", Assumed("the sign opposite to a_y", -1.0), acc=lambda x: -x)
spoilt("A2", "acceleration in g as m/s^2", Assumed("units as the columns state", 9.80665), acc=lambda x: x / 9.80665)

# A3. Samples

for hz in (25, 20, 10):
    spoilt("A3", f"acceleration held at {hz} Hz", Unusable(("a_y", "held")), acc=held(RATE_HZ // hz))
spoilt("A3", "force held at 25 Hz", Unusable(("f", "held")), force=held(4))
spoilt("A3", "both held at 25 Hz", Unusable(("f", "held")), acc=held(4), force=held(4))
spoilt("A3", "acceleration held at 40 Hz, 2 and 3 rows", Unusable(("a_y", "held")),
       acc=lambda x: x[(numpy.arange(ROWS) * 2 // 5) * 5 // 2])
spoilt("A3", "held for 2 to 9 rows, as a bus delivers", Unusable(("a_y", "held")),
       acc=lambda x: x[numpy.maximum.accumulate(numpy.where(numpy.isin(numpy.arange(ROWS), numpy.cumsum(
           numpy.random.default_rng(2).integers(2, 10, ROWS))), numpy.arange(ROWS), 0))])
spoilt("A3", "acceleration in straight lines from 25 Hz", Unusable(("a_y", "held")),
       acc=lambda x: numpy.interp(TIME, TIME[::4], x[::4]))
spoilt("A3", "force in straight lines from 20 Hz", Unusable(("f", "held")),
       force=lambda x: numpy.interp(TIME, TIME[::5], x[::5]))
spoilt("A3", "force in straight lines from 25 Hz", Unusable(("f", "held")),
       force=lambda x: numpy.interp(TIME, TIME[::4], x[::4]))


def noisy(change, share):
    """Noise on top, `share` of the signal's deviation."""
    return lambda x: change(x) + share * numpy.std(x) * numpy.random.default_rng(12).standard_normal(ROWS)


for hz in (50, 30, 25, 10):
    spoilt("A3", f"acceleration held at {hz} Hz behind a noise of 5 %", Unusable(("a_y", "held")),
           acc=noisy(lambda x, hz=hz: x[(numpy.floor(TIME * hz + 1e-6) * RATE_HZ / hz).astype(int)], 0.05))


def held_unevenly(x):
    """For 2 to 9 rows, as a bus delivers."""
    lengths = numpy.random.default_rng(17).integers(2, 10, ROWS)
    return numpy.repeat(x[numpy.minimum(numpy.r_[0, numpy.cumsum(lengths)[:-1]], ROWS - 1)], lengths)[:ROWS]


for share in (0.003, 0.03, 0.1, 0.2):
    spoilt("A3", f"acceleration held for 2 to 9 rows behind a noise of {share:.1%}", Unusable(("a_y", "held")),
           acc=noisy(held_unevenly, share))
for share in (0.03, 0.1):
    spoilt("A3", f"force held for 2 to 9 rows behind a noise of {share:.0%}", Unusable(("f", "held")),
           force=noisy(held_unevenly, share))
spoilt("A3", "force held at 20 Hz behind a noise of 2 %", Unusable(("f", "held")), force=noisy(held(5), 0.02))


def in_lines(hz):
    return lambda x: numpy.interp(TIME, numpy.arange(0.0, TIME[-1] + 1.0 / hz, 1.0 / hz), numpy.interp(
        numpy.arange(0.0, TIME[-1] + 1.0 / hz, 1.0 / hz), TIME, x))


for hz in (10, 20, 25, 30):
    for share in (0.01, 0.03):
        spoilt("A3", f"acceleration in straight lines from {hz:.3g} Hz behind a noise of {share:.0%}",
               Unusable(("a_y", "held")), acc=noisy(in_lines(hz), share))
        spoilt("A3", f"force in straight lines from {hz:.3g} Hz behind a noise of {share:.0%}",
               Unusable(("f", "held")), force=noisy(in_lines(hz), share))
for percent, noise in ((10, 0.02), (20, 0.02), (40, 0.02), (40, 0.2), (68, 0.05)):
    spoilt("A3", f"acceleration clipped in {percent} % of the rows, behind a noise of {noise:.0%}",
           Unusable("did not see"),
           acc=noisy(lambda x, beyond=percent / 200: x.clip(*numpy.quantile(x, [beyond, 1.0 - beyond])), noise))
for percent, noise in ((40, 0.01), (40, 0.2), (10, 0.05)):
    spoilt("A3", f"force clipped in {percent} % of the rows, behind a noise of {noise:.0%}", Unusable("a limit or"),
           force=noisy(lambda x, beyond=percent / 200: x.clip(*numpy.quantile(x, [beyond, 1.0 - beyond])), noise))
spoilt("A3", "force stuck for 3 s", Right(("f", "stuck")),
       force=lambda x: numpy.r_[x[:3000], [x[3000]] * 300, x[3300:]])
spoilt("A3", "acceleration stuck for 0.5 s", Right(("a_y", "stuck")),
       acc=lambda x: numpy.r_[x[:3000], [x[3000]] * 50, x[3050:]])
spoilt("A3", "both stuck for 5 s", Right("stuck"), acc=lambda x: numpy.r_[x[:3000], [x[3000]] * 500, x[3500:]],
       force=lambda x: numpy.r_[x[:3000], [x[3000]] * 500, x[3500:]])
spoilt("A3", "drop-outs to zero, 60 of 3 rows", Right(("f", "drop-outs")),
       force=fill(numpy.concatenate([SOME[:60] + k for k in range(3)]), 0.0))
spoilt("A3", "drop-outs to zero in both, 120 of a row", Right("drop-outs"), force=fill(SOME, 0.0), acc=fill(SOME, 0.0))
spoilt("A3", "force clipped at 2 N", Unusable(("f", "clipped")), force=lambda x: x.clip(-2.0, 2.0))
for name, share in (("68", 0.68), ("40", 0.40), ("20", 0.20)):
    spoilt("A3", f"force clipped in {name} % of the rows", Unusable(("f", "clipped")),
           force=lambda x, share=share: x.clip(*numpy.quantile(x, [share / 2, 1.0 - share / 2])))
spoilt("A3", "acceleration clipped in 40 % of the rows", Unusable(("a_y", "clipped")),
       acc=lambda x: x.clip(*numpy.quantile(x, [0.2, 0.8])))
spoilt("A3", "force clipped on one side, 30 % of the rows", Unusable(("f", "clipped")),
       force=lambda x: x.clip(-99.0, numpy.quantile(x, 0.7)))
spoilt("A3", "12 spikes in the force", Right(("f", "spikes")), force=each(FEW, 60.0))
spoilt("A3", "12 spikes in the acceleration", Right(("a_y", "spikes")), acc=each(FEW, -30.0))
spoilt("A3", "12 spikes in both at once", Right("spikes"), acc=each(FEW, 30.0), force=each(FEW, 60.0))
spoilt("A3", "12 spikes in both, of either sign", Right("spikes"),
       acc=each(FEW, 30.0 * (-1.0)**numpy.arange(12)), force=each(FEW, 60.0 * (-1.0)**(numpy.arange(12) // 2)))
spoilt("A3", "spikes of two rows", Right(("f", "spikes")), force=each(numpy.r_[FEW, FEW + 1], 60.0))
spoilt("A3", "120 spikes", Right(("f", "spikes")), force=each(SOME, 40.0))
spoilt("A3", "-9999 where nothing was measured", Right(("f", "sentinel")), force=fill(FEW, -9999.0))
spoilt("A3", "9.96921e36 where nothing was measured", Right(("a_y", "sentinel")), acc=fill(FEW, 9.96921e36))
spoilt("A3", "one -9999", Right("f"), force=fill(FEW[:1], -9999.0))
spoilt("A3", "-9999 in 60 % of the rows", Unusable("f"),
       force=fill(numpy.random.default_rng(4).random(ROWS) < 0.6, -9999.0))
spoilt("A3", "a counter as force", Unusable(("f", "counter")), force=lambda x: numpy.arange(ROWS))
spoilt("A3", "a counter as acceleration", Unusable(("a_y", "counter")), acc=lambda x: numpy.arange(ROWS) % 256)
spoilt("A3", "the time again as force", Unusable("f"), force=lambda x: TIME)
spoilt("A3", "whole numbers of 16 bits that overflow", Unusable("f"),
       force=lambda x: ((numpy.round(x * 10000.0) + 32768) % 65536 - 32768) / 10000.0)
spoilt("A3", "force in 9 steps", Unusable(("f", "coarse")), force=lambda x: numpy.round(x / 1.5) * 1.5)
table("A3", "a thermometer that sticks after 30 s", Right(("temp", "stuck")), header=HEADER + ",temp",
      columns=(TIME, ACC, FORCE, numpy.r_[21.0 + numpy.random.default_rng(6).standard_normal(3000), [21.5] * 3000]),
      words=[*MAP, "temp=temp [degC]"])

# A4. Stored scale

PACKED = numpy.round(FORCE * 500.0).astype("<i2")
hdf5("A4", "int16 with scale_factor, add_offset, units", Right("scale_factor"), {
    "time": (TIME, {"units": "s"}), "acc": (ACC, {"units": "m/s^2"}),
    "force": (PACKED, {"scale_factor": 0.002, "add_offset": 0.0, "units": "N"})})
hdf5("A4", "missing_value of a packed set", Right(), {
    "time": (TIME, {}), "acc": (ACC, {}),
    "force": (fill(FEW, -32768)(PACKED.copy()), {"scale_factor": 0.002, "missing_value": numpy.int16(-32768)})})
hdf5("A4", "valid_range of a packed set", Right(), {
    "time": (TIME, {}), "acc": (ACC, {}),
    "force": (fill(FEW, -32700)(PACKED.copy()),
              {"scale_factor": 0.002, "valid_range": numpy.array([-32000, 32000], "i2")})})
hdf5("A4", "_Unsigned bytes", Right(), {
    "time": (TIME, {}), "acc": (ACC, {}),
    "force": (numpy.round(FORCE * 500.0 + 32768).astype("<u2").view("<i2"),
              {"scale_factor": 0.002, "add_offset": -65.536, "_Unsigned": "true"})})
hdf5("A4", "scale_factor of one element in a list", Right(), {
    "time": (TIME, {}), "acc": (ACC, {}), "force": (PACKED, {"scale_factor": numpy.array([0.002])})})
hdf5("A4", "units of milli-g", Right("times"), {
    "time": (TIME, {}), "acc": (ACC / 9.80665e-3, {"units": "mg"}), "force": (FORCE, {"units": "N"})})
hdf5("A4", "time as 'milliseconds since'", Right(), {
    "time": (TIME * 1e3, {"units": "milliseconds since 2026-11-26 10:00:00"}), "acc": (ACC, {}), "force": (FORCE, {})})
hdf5("A4", "time as 'seconds since'", Right(), {
    "time": (TIME, {"units": "seconds since 1970-01-01 00:00:00"}), "acc": (ACC, {}), "force": (FORCE, {})})
hdf5("A4", "units that nobody knows", Refused(("counts",)), {
    "time": (TIME, {}), "acc": (ACC, {}), "force": (PACKED, {"units": "counts"})})


def timetable_units():
    columns = {"Time": TIME, "acc": ACC / 9.80665, "force": FORCE / 1e3}
    names, units = (numpy.array([list(each)], dtype=object) for each in (("acc", "force"), ("g", "kN")))
    return {"ride": {**columns, "Properties": {"VariableNames": names, "VariableUnits": units}}}


RIDE_MAP = ["--map", "ride.Time=t [s]", "ride.acc=a_y [m/s^2]", "ride.force=f [N]"]
matlab("A4", "a timetable as a struct, VariableUnits", Right("times"), timetable_units, words=RIDE_MAP)
matlab("A4", "a timeseries as a struct, DataInfo.Units", Right("times"), lambda: {
    "acc": {"Time": TIME, "Data": ACC / 9.80665, "DataInfo": {"Units": "g"}},
    "force": {"Time": TIME, "Data": FORCE / 1e3, "DataInfo": {"Units": "kN"}}},
       words=["--map", "acc.Time=t [s]", "acc.Data=a_y [m/s^2]", "force.Data=f [N]"])
matlab("A4", "a unit next to each signal, as dSPACE writes", Right("times"), lambda: {
    "rec": {"X": {"Data": TIME, "Unit": "s"}, "acc": {"Data": ACC / 9.80665, "Unit": "g"},
            "force": {"Data": FORCE / 1e3, "Unit": "kN"}}},
       words=["--map", "rec.X.Data=t [s]", "rec.acc.Data=a_y [m/s^2]", "rec.force.Data=f [N]"])
LABVIEW = ("LabVIEW Measurement\t\r\nSeparator\tTab\r\nDecimal_Separator\t.\r\n{0}***End_of_Header***\t\r\n\t\r\n"
           "Channels\t2\t\t\r\nSamples\t6000\t6000\t\r\n{1}***End_of_Header***\t\t\t\r\n")
table("A4", "LabVIEW's Y_Unit_Label", Right("times"),
      words=["--map", "X_Value=t [s]", "acc=a_y [m/s^2]", "force=f [N]"],
      above=LABVIEW.format("", "Y_Unit_Label\tg\tkN\t\r\n"), header="X_Value\tacc\tforce\tComment", separator="\t",
      end="\r\n", columns=(TIME, ACC / 9.80665, FORCE / 1e3))

# A5. Impossible times

table("A5", "title ms, values in seconds", Refused(("Hz", "1000")), words=[], header="t [ms],a_y [m/s^2],f [N]")
table("A5", "title us, values in ms", Refused(("Hz",)), words=[], header="t [us],a_y [m/s^2],f [N]",
      first=lambda t: repr(round(1e3 * t)))
table("A5", "title s, values in ms", Refused(("t [ms]",)), words=[], header="t [s],a_y [m/s^2],f [N]",
      first=lambda t: repr(round(1e3 * t)))
table("A5", "values in ms mapped as seconds", Refused(("t [ms]",)), first=lambda t: repr(round(1e3 * t)))
table("A5", "values in us mapped as ms", Refused(("Hz",)), words=["--map", "time=t [s]", *MAP[2:]],
      first=lambda t: repr(round(1e6 * t)))
table("A5", "seconds mapped as ms", Refused(("Hz", "1000")), words=["--map", "time=t [ms]", *MAP[2:]])
table("A5", "ns since 1970 mapped as seconds", Refused(("time",)), first=lambda t: repr(round(1e9 * t) + 17 * 10**17))
table("A5", "days, as a spreadsheet counts them", Refused(("Hz",)), first=lambda t: repr(46352.0 + t / 86400.0))
table("A5", "the number of the row as time", Refused(("--sample-rate",)), first=lambda t: repr(round(100 * t)))
MEMBERS.append(Member("A5", "WAV of 44100 Hz in its head", lambda folder: (sound(folder, 44100), SOUND_MAP),
                      Refused(("Hz",))))
MEMBERS.append(Member("A5", "WAV of 8000 Hz in its head", lambda folder: (sound(folder, 8000), SOUND_MAP),
                      Refused(("8000 Hz",))))
table("A5", "--sample-rate 1e6", Refused(("Hz",)), words=["--map", *MAP[2:], "--sample-rate", "1000000"])

# A6. Messages that do not fit


def misfits(which, change):
    return lambda topic, n, data: change(data) if topic == "/stick" and which(n) else data


bagged("A6", "one message in 200 is cut", Right("do not fit"),
       messages=misfits(lambda n: n % 200 == 7, lambda d: d[:40]))
bagged("A6", "one in 10 is cut", Refused(("do not fit", "5 %")),
       messages=misfits(lambda n: n % 10 == 7, lambda d: d[:40]))
bagged("A6", "the last 10 s are of another definition", Refused(("do not fit",)),
       messages=misfits(lambda n: n >= 5000, lambda d: d[:44]))
bagged("A6", "one in 10 has bytes behind its members", Right("longer than"),
       messages=misfits(lambda n: n % 10 == 7, lambda d: d + bytes(8)))
bagged("A6", "every message has a member more", Right("longer than"), messages=misfits(lambda n: True, lambda d: d + bytes(24)))
bagged("A6", "values that are not finite", Refused(("inf in f",)),
       messages=misfits(lambda n: n % 10 == 7, lambda d: d[:28] + struct.pack("<d", float("inf")) + d[36:]))
bagged("A6", "2 s without a message of one topic", Right("gap"),
       messages=misfits(lambda n: 3000 <= n < 3200, lambda d: None))

# A7. Cut files, degrees


def cut_file(kind, name, right, make, share, words=MAP, needs=True):
    MEMBERS.append(Member(kind, name, lambda folder: (cut(make(folder), share), words), right, needs=needs))


cut_file("A7", "WAV cut at two thirds", Right("cut off"), sound, 2 / 3, SOUND_MAP)
cut_file("A7", "WAV cut at 30 s, its head of a pipe", Right(), lambda folder: piped(sound(folder)), 0.5, SOUND_MAP)
cut_file("A7", "MCAP cut at 80 %", Right("lost at its end"), bag, 0.8, BAG_MAP)
def cut_row(folder, commas):
    """The table up to the third character behind a comma of a row in its middle."""
    path = text(folder)
    content = path.read_text(encoding="utf-8")
    at = content.index("\n", len(content) // 2)
    for _ in range(commas):
        at = content.index(",", at + 1)
    path.write_text(content[:at + 3], encoding="utf-8")
    return path


# A row that ends within its last number is a whole row of many programs, which write no line end there.
for name, commas, right in (("CSV cut within a row", 1, Right("cut off")),
                            ("CSV cut within its last number", 2, Right())):
    MEMBERS.append(Member("A7", name, lambda folder, commas=commas: (cut_row(folder, commas), MAP), right))


def piped(path):
    """Sizes of the head that were never written."""
    whole = bytearray(path.read_bytes())
    whole[4:8] = whole[40:44] = b"\xff" * 4
    path.write_bytes(whole)
    return path


def cut_hdf5(folder):
    path = folder / "cut.h5"
    with h5py.File(path, "w") as file:
        for title, values in (("time", TIME), ("acc", ACC), ("force", FORCE)):
            file[title] = values
    return path


def cut_matlab(folder):
    path = folder / "cut.mat"
    scipy.io.savemat(path, {"time": TIME, "acc": ACC, "force": FORCE})
    return path


cut_file("A7", "HDF5 cut at 60 %", Refused(("cut off",)), cut_hdf5, 0.6, needs=h5py)
cut_file("A7", "MATLAB cut at 60 %", Refused(("cut off",)), cut_matlab, 0.6, needs=scipy)
ANGLE = numpy.degrees(0.3 * draw(11)[1])
ANGLES = (TIME, ACC, FORCE, ANGLE)
ANGLE_MAP = [*MAP, "angle=theta [rad]"]
IN_DEGREES = "times 0.0174533"
for name, above in (("inDegrees=yes", "ride\ninDegrees=yes\nendheader\n"),
                    ("inDegrees = Yes", "ride\ninDegrees = Yes\n"),
                    ("a comment, # inDegrees=yes", "# inDegrees=yes\n")):
    table("A7", name, Right(IN_DEGREES), words=ANGLE_MAP, above=above, header="time,acc,force,angle", columns=ANGLES)
table("A7", "angle (deg)", Right(IN_DEGREES), words=ANGLE_MAP, header="time,acc,force,angle (deg)", columns=ANGLES)
table("A7", "angle [°]", Right(IN_DEGREES), words=ANGLE_MAP, header="time,acc,force,angle [°]", columns=ANGLES)
table("A7", "angle_deg", Refused(("angle_deg=theta [deg]",)), words=[], header="time,acc,force,angle_deg",
      columns=ANGLES,
      pasted=True)
table("A7", "degrees without a word", Right(("theta", "unit")), words=ANGLE_MAP, header="time,acc,force,angle",
      columns=ANGLES)

# B8. Ragged tables

LVM_MAP = ["--map", "X_Value=t [s]", "acc=a_y [m/s^2]", "force=f [N]"]
table("B8", "LVM with a title without cells", Right(), words=LVM_MAP, above=LABVIEW.format("", ""),
      header="X_Value\tacc\tforce\tComment", separator="\t", end="\r\n")
table("B8", "LVM with a comment in the first row", Right(), words=LVM_MAP, above=LABVIEW.format("", ""),
      header="X_Value\tacc\tforce\tComment", separator="\t", end="\r\n",
      columns=(TIME, ACC, FORCE, numpy.array(["ride of Anna"] + [""] * (ROWS - 1))))
table("B8", "LVM without times, Delta_X", Right(), words=["--map", "acc=a_y [m/s^2]", "force=f [N]"],
      above=LABVIEW.format("X_Columns\tNo\r\n", "X_Dimension\tTime\tTime\r\nDelta_X\t0.010000\t0.010000\r\n"),
      header="X_Value\tacc\tforce\tComment", separator="\t", end="\r\n", first=lambda t: "")
table("B8", "a separator at the end of rows", Right(), row_end=",")
table("B8", "a separator at the end of the titles", Right(), header=HEADER + ",")
table("B8", "a separator at the end of both", Right(), header=HEADER + ",", row_end=",")
table("B8", "a header line that holds the rate", Right(), above="100\n")
table("B8", "a header line that holds rate and rows", Right(), above="100,6000\n")
table("B8", "zeros behind good rows", Right("zero"), tail="\0" * 4096)
table("B8", "zeros between good rows", Refused(("binary",)), header=HEADER + "\n0.0,0.0,0.0\n" + "\0" * 512)
table("B8", "a footer of text", Right("text"), tail="End of recording\nRows: 6000\n")
table("B8", "an empty line every 100 rows", Right(), columns=(TIME, ACC, FORCE),
      first=lambda t: ("\n" if round(t * 100) % 100 == 99 else "") + repr(t))
table("B8", "titles again where the logger began again", Refused((":3002:", "'time'")),
      first=lambda t: (HEADER + "\n" if t == 30.0 else "") + repr(t))
table("B8", "titles in quotes, with a separator in one", Right(), header='"time","acc","force, stick"',
      words=["--map", "time=t [s]", "acc=a_y [m/s^2]", "force, stick=f [N]"])
table("B8", "rows without their last cells", Right("lack a value"),
      columns=(TIME, ACC, [repr(f) if n % 50 else "" for n, f in enumerate(FORCE.tolist())]))
table("B8", "a title too few", Refused(("titles",)), header="time,acc")

# B9. Suggestions, and what happens when they are pasted

table("B9", "a counter ahead of the time", Refused(("'time=t [s]'",)), words=[], header="sample,time,acc,force",
      columns=(numpy.arange(ROWS), TIME, ACC, FORCE), first=lambda n: repr(int(n)), pasted=True)
table("B9", "a counter and no time", Refused(("--sample-rate",)), words=[], header="n,acc,force",
      first=lambda t: repr(round(100 * t)))
table("B9", "a counter called time", Refused(("--sample-rate",)), words=[], header="time,acc,force",
      first=lambda t: repr(round(100 * t)))
table("B9", "ISO 8601 stamps", Refused(("time=t [s]",)), words=[], first=lambda t: stamp(t).isoformat(), pasted=True)
table("B9", "ISO 8601 with a zone", Right(), first=lambda t: stamp(t).isoformat() + "+01:00")
table("B9", "ISO 8601 with a blank and Z", Right(), first=lambda t: stamp(t).isoformat(" ") + "Z")
table("B9", "ISO 8601, basic form", Right(), first=lambda t: stamp(t).strftime("%Y%m%dT%H%M%S.%f"))
table("B9", "stamps with slashes", Right(), first=lambda t: stamp(t).strftime("%Y/%m/%d %H:%M:%S.%f"))
table("B9", "a German date", Right(), separator=";", first=lambda t: stamp(t).strftime("%d.%m.%Y %H:%M:%S,%f"),
      decimal=",", header="time;acc;force")
table("B9", "an American date, AM", Refused(("time",)), first=lambda t: stamp(t).strftime("%m/%d/%Y %I:%M:%S.%f %p"))
table("B9", "date and clock in two columns", Refused(("clock=t",)), words=[], header="date,clock,acc,force",
      first=lambda t: stamp(t).date().isoformat() + "," + stamp(t).time().isoformat(), pasted=True)
table("B9", "a clock of minutes and seconds", Right(), first=lambda t: f"00:{int(t // 60):02}:{t % 60:06.3f}")
table("B9", "blocks of ten rows with one stamp", Refused(("--sample-rate 100",)),
      first=lambda t: repr(float(numpy.floor(t * 10.0 + 1e-9) / 10.0)))
table("B9", "stamps of whole seconds", Refused(("--sample-rate 100",)), first=lambda t: repr(int(t)))
table("B9", "ms of whole numbers", Refused(("time=t [ms]",)), words=[], first=lambda t: repr(round(1e3 * t)),
      pasted=True)
table("B9", "us in steps of 10000", Refused(("time=t [us]",)), words=[], first=lambda t: repr(round(1e6 * t)),
      pasted=True)
table("B9", "ns since 1970", Refused(("time=t [ns]",)), words=[], first=lambda t: repr(17 * 10**17 + round(1e9 * t)),
      pasted=True)
table("B9", "units in the titles' ends", Refused(("time_ms=t [ms]", "acc_g=a_y [g]", "force_kN=f [kN]")), words=[],
      header="time_ms,acc_g,force_kN", columns=(TIME, ACC / 9.80665,
                                              FORCE / 1e3), first=lambda t: repr(1e3 * t), pasted=True)

# B10. MATLAB's other shapes

SIGNALS = [f"signal {n}" for n in range(40)]


def struct_array():
    signals = numpy.zeros(40, dtype=[("Name", "O"), ("Data", "O")])
    for n in range(40):
        signals[n] = (f"signal {n}", {16: ACC, 39: FORCE}.get(n, numpy.zeros(ROWS)))
    return {"rec": {"X": TIME, "Y": signals}}


def cells(*values):
    out = numpy.empty(len(values), dtype=object)
    out[:] = values
    return out


matlab("B10", "a struct array of 40 elements", Right(), struct_array,
       words=["--map", "rec.X=t [s]", "rec.Y(17).Data=a_y [m/s^2]", "rec.Y(40).Data=f [N]"])
matlab("B10", "cells", Right(), lambda: {"log": cells(TIME, ACC, FORCE)},
       words=["--map", "log{1}=t [s]", "log{2}=a_y [m/s^2]", "log{3}=f [N]"])
matlab("B10", "cells in a struct in a cell", Right(), lambda: {"log": cells({"run": cells(TIME, ACC, FORCE)}, "ride")},
       words=["--map", "log{1}.run{1}=t [s]", "log{1}.run{2}=a_y [m/s^2]", "log{1}.run{3}=f [N]"])
matlab("B10", "complex numbers", Refused(("complex",)), lambda: {"both": ACC + 1j * FORCE}, words=[])
matlab("B10", "three dimensions", Refused(("3 dimensions",)), lambda: {"cube": numpy.zeros((60, 3, 3))}, words=[])
matlab("B10", "a wanted one is complex", Refused(("complex",)),
       lambda: {"time": TIME, "acc": ACC, "force": FORCE + 1j * FORCE})
NESTED = numpy.zeros(ROWS, dtype=[("time", "f8"), ("imu", [("acc", "f8")]), ("stick", [("force", "f8")])])
NESTED["time"], NESTED["imu"]["acc"], NESTED["stick"]["force"] = TIME, ACC, FORCE
hdf5("B10", "a compound in a compound", Refused(("a compound",)), {"table": (NESTED, {})},
     words=["--map", "table.time=t [s]", "table.imu.acc=a_y [m/s^2]", "table.stick.force=f [N]"])
hdf5("B10", "three dimensions", Refused(("3 dimensions",)), {"cube": (numpy.zeros((60, 3, 3)), {})}, words=[])

# B11. Files of other kinds

for name, begin, words in (("ride.db3", b"SQLite format 3\0", "rosbags-convert"),
                           ("ride.mcap.zst", b"\x28\xb5\x2f\xfd", "zstd -d"),
                           ("ride.csv.gz", b"\x1f\x8b\x08", "gunzip"), ("ride.csv.bz2", b"BZh91AY&SY", "bunzip2"),
                           ("ride.7z", b"7z\xbc\xaf\x27\x1c", "7z"), ("ride.xlsx", b"PK\x03\x04", "csv"),
                           ("ride.xls", b"\xd0\xcf\x11\xe0", "csv"), ("ride.tdms_index", b"TDSh", ".tdms"), ("ride.mf4",
                                                                   b"MDF     ", "asammdf"),
                           ("ride.c3d", b"\x02\x50", "ezc3d"), ("ride.parquet", b"PAR1",
                                                                   "pandas"),
                           ("ride.bag", b"#ROSBAG V2.0\n", "rosbags-convert"), ("ride.npy", b"\x93NUMPY", "numpy"),
                           ("ride.npz", b"PK\x03\x04" + bytes(26) + b"t.npy", "numpy.column_stack"), ("ride.edf", b"0       X X", "edf"), ("ride.feather",
                                                                   b"ARROW1", "pandas"),
                           ("pandas.pkl", b"\x80\x05\x95", "pandas"), ("ride.pkl", b"\x80\x04\x95", "pandas"), ("ride.blf", b"LOGG", "can")):
    def other(folder, name=name, begin=begin):
        (folder / name).write_bytes(begin + bytes(range(256)) * 20)
        return folder / name, []
    MEMBERS.append(Member("B11", name, other, Refused((words,))))


# XDF: streams of LabRecorder, each with the clock of its sender

XDF_MAP = ["--map", "platform.y=a_y", "stick.force=f"]
RECORDER_S = 50000.0  # [s] its clock when the recording began


def chunk(tag, content):
    return b"\x04" + struct.pack("<IH", 2 + len(content), tag) + content


def xdf_header(number, name, channels, form="double64", rate_hz=RATE_HZ):
    listed = "".join(f"<channel><label>{label}</label><unit>{unit}</unit></channel>" for label, unit in channels)
    return chunk(2, struct.pack("<I", number) + (
        f"<?xml version=\"1.0\"?><info><name>{name}</name><channel_count>{len(channels)}</channel_count><nominal_srate>"
        f"{rate_hz}</nominal_srate><channel_format>{form}</channel_format><desc><channels>{listed}</channels></desc>"
        "</info>").encode())


def xdf_samples(number, stamps, values, code="d"):
    """A chunk of samples; a stamp None is left to the reader."""
    content = struct.pack("<IBI", number, 4, len(stamps))
    for time_s, value in zip(stamps, values):
        content += b"\0" if time_s is None else struct.pack("<Bd", 8, time_s)
        content += struct.pack("<" + code, value)
    return chunk(3, content)


def xdf(folder, stamp=lambda i, time_s: time_s, slope=2e-5, offset_s=-4321.5, offsets=lambda at_s, by_s: by_s,
        force=FORCE, unit="N", form=("double64", "d"), pause_s=0.0, spoil=lambda parts: parts):
    """The platform by the recorder's clock, the stick by one that is `offset_s` behind and runs `slope` faster."""
    parts = [b"XDF:", chunk(1, b"<?xml version=\"1.0\"?><info><version>1.0</version></info>"),
             xdf_header(7, "platform", [("y", "m/s^2")]), xdf_header(2, "stick", [("force", unit)], form[0]),
             xdf_header(3, "markers", [("text", "")], "string", 0)]
    random = numpy.random.default_rng(3)
    for first in range(0, ROWS, 50):
        rows = range(first, min(first + 50, ROWS))
        at = [RECORDER_S + TIME[i] + pause_s * (i >= 4500) for i in rows]
        parts.append(xdf_samples(7, at, ACC[first:first + 50]))
        theirs = [stamp(i, (t - offset_s) / (1.0 + slope)) for i, t in zip(rows, at)]
        parts.append(xdf_samples(2, theirs, force[first:first + 50], form[1]))
        if first % 500 == 0:
            their_s = (at[0] - offset_s) / (1.0 + slope)
            by_s = offsets(at[0] - RECORDER_S, at[0] - their_s + 1e-4 * random.standard_normal())
            if by_s is not None:
                parts.append(chunk(4, struct.pack("<Idd", 2, their_s, by_s)))
            parts.append(chunk(4, struct.pack("<Idd", 7, at[0], 1e-5)))
            parts.append(chunk(5, bytes(16)))
            parts.append(chunk(3, struct.pack("<IBBBdBB", 3, 1, 1, 8, at[0], 1, 2) + b"go"))
    path = folder / "ride.xdf"
    path.write_bytes(b"".join(spoil(parts)))
    return path, XDF_MAP


def streams(name, right, **form):
    MEMBERS.append(Member("B11", "XDF, " + name, lambda folder: xdf(folder, **form), right))


streams("two streams with clocks of their own", Right())
streams("a clock that runs 1 % fast", Right(), slope=0.01)
streams("stamps at each tenth sample alone", Right(), stamp=lambda i, time_s: time_s if i % 10 == 0 else None,
        slope=0.0)
streams("stamps with a jitter of 1 ms", Right(),
        stamp=lambda i, time_s, noise=numpy.random.default_rng(4).uniform(-1e-3, 1e-3, ROWS): time_s + noise[i])
streams("whole numbers of 16 bits", Right(), force=numpy.round(1000 * FORCE).astype(int), form=("int16", "h"),
        unit="mN")
streams("one clock offset in ten is wrong by 50 ms", Right(),
        offsets=lambda at_s, by_s: by_s + 0.05 * (at_s == 30.0))
streams("cut off", Right(), spoil=lambda parts: parts[:200] + [parts[200][:20]])
streams("no clock offsets, and a clock of its own", Refused(("no clock offsets of 'stick'",)),
        offsets=lambda at_s, by_s: None)
streams("no clock offsets, and 0.3 s late", Refused(("no clock offsets of 'stick'",)),
        offsets=lambda at_s, by_s: None, offset_s=-0.3, slope=0.0)
streams("a clock that was set by 0.5 s", Refused(("clock offsets of 'stick'",)),
        offsets=lambda at_s, by_s: by_s + 0.5 * (at_s > 30.0))
streams("stamps that go back", Refused(("do not go on",)),
        stamp=lambda i, time_s: time_s - 5.0 * (i >= 3000))
UNEVEN_S = numpy.random.default_rng(5).uniform(-8e-3, 8e-3, ROWS // 10)  # of chunks of 10 rows
streams("chunks that came unevenly, whose stamps overlap", Right("overlap"),
        stamp=lambda i, time_s: time_s + UNEVEN_S[i // 10])
streams("chunks whose stamps overlap, and a pause of 2 s", Right("overlap"),
        stamp=lambda i, time_s: time_s + UNEVEN_S[i // 10], pause_s=2.0)
streams("chunks whose stamps overlap, and 30 samples lost", Refused(("do not go on",)),
        stamp=lambda i, time_s: time_s + UNEVEN_S[i // 10] + 0.3 * (i >= 3000))
streams("50 samples lost, and stamps at the first alone", Unusable(""), slope=0.0,
        stamp=lambda i, time_s: time_s if i == 0 else None, force=numpy.concatenate([FORCE[:3000], FORCE[3050:],
                                                                                    FORCE[:50]]))
streams("a chunk that states too many samples", Refused(("byte",)),
        spoil=lambda parts: parts[:5] + [parts[5].replace(struct.pack("<BI", 4, 50), struct.pack("<BI", 4, 51))] + parts[6:])
# TDMS of LabVIEW (NI, "TDMS File Format Internal Structure")

TDMS_MAP = ["--map", "ride.acc=a_y", "ride.force=f"]
TDMS_TYPES = {"i2": 2, "f4": 9, "f8": 10}
META, NEW_LIST, RAW, INTERLEAVED, DAQMX = 2, 4, 8, 32, 128
AS_BEFORE, NO_RAW = b"\0" * 4, b"\xff" * 4


def tdms_text(words):
    return struct.pack("<I", len(words.encode())) + words.encode()


def tdms_value(value):
    """Type and value of a property; a tuple is a time stamp, seconds since 1904 and 1/2^64."""
    if isinstance(value, str):
        return struct.pack("<I", 0x20) + tdms_text(value)
    if isinstance(value, tuple):
        return struct.pack("<IQq", 0x44, value[1], value[0])
    return struct.pack("<II", 7, value) if isinstance(value, int) else struct.pack("<Id", 10, value)


def tdms_object(path, index=NO_RAW, properties=None):
    """`index`: NO_RAW, AS_BEFORE, or type and number of values."""
    properties = properties or {}
    if isinstance(index, tuple):
        index = struct.pack("<IIIQ", 20, TDMS_TYPES[index[0]], 1, index[1])
    return (tdms_text(path) + index + struct.pack("<I", len(properties)) +
            b"".join(tdms_text(key) + tdms_value(value) for key, value in properties.items()))


def tdms_segment(objects, raw, contents, next_at=None):
    meta = struct.pack("<I", len(objects)) + b"".join(objects) if objects else b""
    contents |= (META if objects else 0) | (RAW if raw else 0)
    next_at = len(meta) + len(raw) if next_at is None else next_at
    return b"TDSm" + struct.pack("<IIQQ", contents, 4713, next_at, len(meta)) + meta + raw


def waveform(unit, start_s=3.84e9, step_s=1.0 / RATE_HZ, **more):
    return {"wf_start_time": (int(start_s), round((start_s % 1.0) * 2**64)), "wf_start_offset": 0.0,
            "wf_increment": step_s, "unit_string": unit, **more}


def linear(slope, intercept, source=0xFFFFFFFF, number=0, **more):
    scale = f"NI_Scale[{number}]_"
    return {"NI_Scaling_Status": "unscaled", "NI_Number_Of_Scales": number + 1, scale + "Scale_Type": "Linear",
            scale + "Linear_Slope": slope, scale + "Linear_Y_Intercept": intercept,
            scale + "Linear_Input_Source": source, **more}


def tdms(acc=ACC, force=FORCE, kinds=("f8", "f8"), of_acc=None, of_force=None, paths=("/'ride'/'acc'", "/'ride'/'force'"),
         pieces=(ROWS,), interleaved=False, later=lambda row: {}, contents=0, last=None, again=AS_BEFORE):
    """A segment for each of the pieces; the first one names the channels, the others say "as before"."""
    of = [waveform("m/s^2") if of_acc is None else of_acc, waveform("N") if of_force is None else of_force]
    out, row = [], 0
    for number, rows in enumerate(pieces):
        parts = [values[row:row + rows].astype("<" + kind) for values, kind in zip((acc, force), kinds)]
        if interleaved:
            raw = numpy.rec.fromarrays(parts).tobytes()
        else:
            raw = b"".join(part.tobytes() for part in parts)
        if number == 0 or rows != pieces[number - 1]:
            objects = [tdms_object(path, (kind, rows), own if number == 0 else later(row))
                       for path, kind, own in zip(paths, kinds, of)]
            objects = ([tdms_object("/"), tdms_object("/'ride'")] if number == 0 else []) + objects
        else:
            objects = [tdms_object(path, again, later(row)) for path in paths] if later(row) else []
        flags = contents | (INTERLEAVED if interleaved else 0) | (NEW_LIST if number == 0 else 0)
        out.append(tdms_segment(objects, raw, flags, last if rows + row >= ROWS else None))
        row += rows
    return b"".join(out)


def labview(name, right, words=None, spoil=lambda content: content, **form):
    def make(folder):
        path = folder / "ride.tdms"
        path.write_bytes(spoil(tdms(**form)))
        return path, TDMS_MAP if words is None else words
    MEMBERS.append(Member("B11", "TDMS, " + name, make, right))


COUNTS = numpy.round(FORCE * 500.0)
PAUSE = {"pieces": (2000, 2000, 2000),
         "later": lambda row: {"wf_start_time": (3840000000 + row // 100 + (60 if row >= 4000 else 0), 0)}}
labview("two channels", Right())
labview("many segments with \"as before\", and a shorter last one", Right(), pieces=(700,) * 8 + (400,))
labview("interleaved", Right(), interleaved=True, pieces=(1000,) * 6)
labview("four chunks in a segment", Right(), spoil=lambda content: content.replace(
    struct.pack("<IIIQ", 20, 10, 1, ROWS), struct.pack("<IIIQ", 20, 10, 1, ROWS // 4)),
        acc=numpy.r_[ACC[:1500], FORCE[:1500], ACC[1500:3000], FORCE[1500:3000]],
        force=numpy.r_[ACC[3000:4500], FORCE[3000:4500], ACC[4500:], FORCE[4500:]])
labview("scaled whole numbers of 16 bits", Right(), force=COUNTS, kinds=("f8", "i2"),
        of_force=waveform("N", **linear(0.002, 0.0)))
labview("a scale of a scale, in kN", Right("times"), force=COUNTS, kinds=("f4", "i2"), of_force=waveform(
    "kN", **{**linear(2.0, 0.0), **linear(1e-6, 0.0, source=0, number=1)}))
labview("a recording that was stopped for 60 s", Right("gap"), **PAUSE)
labview("a recording that was begun again an hour earlier", Refused(("do not go on",)), pieces=(3000, 3000),
        later=lambda row: {"wf_start_time": (3840000000 - 3600, 0)})
labview("a writer that was stopped", Right("cut off"), last=2**64 - 1, pieces=(1000,) * 6,
        spoil=lambda content: content[:-3333])
labview("cut off, interleaved", Right("cut off"), interleaved=True, spoil=lambda content: content[:-10007])
labview("no times, and --sample-rate", Right(), of_acc={"unit_string": "m/s^2"}, of_force={"NI_UnitDescription": "N"},
        words=[*TDMS_MAP, "--sample-rate", "100"])
labview("no times", Refused(("--sample-rate",)), of_acc={"unit_string": "m/s^2"}, of_force={"unit_string": "N"})
labview("two groups that started 0.255 s apart", Right("at the times of"), paths=("/'cabin'/'y'", "/'rig''s'/'y'"),
        words=["--map", "cabin.y=a_y", "rig's.y=f"], of_force=waveform("N", 3.84e9 - 0.255),
        force=numpy.fft.irfft(numpy.fft.rfft(FORCE) * numpy.exp(
            -2j * numpy.pi * 0.255 * numpy.fft.rfftfreq(ROWS, 1.0 / RATE_HZ)), ROWS))
labview("DAQmx raw data", Refused(("DAQmx", "nptdms")), contents=DAQMX)
labview("a table as scale", Refused(("'Table'", "force")), force=COUNTS, kinds=("f8", "i2"), of_force=waveform(
    "N", **{**linear(0.002, 0.0), "NI_Scale[0]_Scale_Type": "Table"}))
labview("scales in a circle", Refused(("circle",)), of_force=waveform("N", **linear(2.0, 0.0, source=0)))
labview("values that are scaled already, and a scale", Refused(("'scaled'",)),
        of_force=waveform("N", **{**linear(2.0, 0.0), "NI_Scaling_Status": "scaled"}))
labview("a chunk that states too many values", Refused(("byte",)), spoil=lambda content: content.replace(
    struct.pack("<IIIQ", 20, 10, 1, ROWS), struct.pack("<IIIQ", 20, 10, 1, 2**60)))
labview("the start of the force 0.3 s late", Unusable("leads"), of_force=waveform("N", 3.84e9 - 0.3))
labview("its rate ten times too high", Refused(("Hz",)), of_acc=waveform("m/s^2", step_s=1e-5),
        of_force=waveform("N", step_s=1e-5))
MEMBERS.append(Member("B11", "a folder", lambda folder: (folder, []), Refused(("a folder",))))


@member("B11", "a folder of rosbag2", Refused(("bag.mcap",)))
def rosbag2(folder):
    bag(folder)
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information:\n")
    return folder, []


# B12. Internal names in messages

spoilt("B12", "inf in the force", Refused(("f",)), force=put(1000, 1001, numpy.inf))
spoilt("B12", "1e300 in the force", Right(("f", "sentinel")), force=put(1000, 1003, 1e300))
spoilt("B12", "1e200 once in the acceleration", Right("a_y"), acc=put(1000, 1001, 1e200))
spoilt("B12", "a constant force", Refused(("f",)), force=put(0, ROWS, 1.0))
spoilt("B12", "zeros alone as acceleration", Refused(("a_y",)), acc=put(0, ROWS, 0.0))
table("B12", "80 rows", Refused(("ride.csv",)), columns=(TIME[:80], ACC[:80], FORCE[:80]))
table("B12", "one row", Refused(("row",)), columns=(TIME[:1], ACC[:1], FORCE[:1]))
table("B12", "the force is not there", Refused(("'f'",)), words=MAP[:3])
table("B12", "text in the force", Refused((":1002:", "'over'")),
      columns=(TIME, ACC, ["over" if n == 1000 else repr(f) for n, f in enumerate(FORCE.tolist())]))

# B13. Encodings and numbers

for name, form in (
        ("UTF-16 without mark", dict(encoding="utf-16-le")), ("UTF-16, the other order, without mark",
                                                dict(encoding="utf-16-be")),
        ("UTF-16 with mark", dict(encoding="utf-16")), ("UTF-8 with mark", dict(header="\ufeff" + HEADER)),
        ("UTF-32 with mark", dict(encoding="utf-32")),
        ("CR ends", dict(end="\r")), ("CRLF ends, a CR too many", dict(end="\r\r\n")), ("CR ends in UTF-16",
                                                dict(end="\r", encoding="utf-16")),
        ("a no-break space in a title", dict(header="t\u00a0[s],a_y\u00a0[m/s^2],f\u00a0[N]", words=[])),
        ("a thin space in a title", dict(header="t\u2009[s],a_y\u2009[m/s²],f\u202f[N]", words=[])),
        ("m/s² and µ in titles, Windows-1252", dict(header="t [µs],a_y [m/s²],f [N]", words=[],
                                                   encoding="windows-1252",
                                                   first=lambda t: repr(round(1e6 * t)))),
        ("m·s⁻² in a title", dict(header="t [s],a_y [m·s⁻²],f [N]", words=[])),
        ("m/s^2 as m/s2", dict(header="t [s],a_y [m/s2],f [N]", words=[])),
        ("U+2212 as minus", dict(columns=(TIME, [repr(a).replace("-", "\u2212") for a in ACC.tolist()], FORCE)))):
    table("B13", name, Right(), **form)


def fortran(values):
    return [f"{value:.15E}".replace("E", "D") for value in values]


table("B13", "a decimal comma after 1500 whole rows", Right(), separator=";", header="time;acc;force",
      first=lambda t: str(round(1e3 * t)), words=["--map", "time=t [ms]", "acc=a_y [m/s^2]", "force=f [N]"],
      columns=(TIME, *(["0"] * 1500 + [repr(value).replace(".", ",") for value in values[1500:].tolist()]
                       for values in (ACC, FORCE))))
table("B13", "D exponents", Right(), columns=(TIME, fortran(ACC), fortran(FORCE)))
table("B13", "d exponents in small letters, blanks between", Right(), separator="  ", header="time acc force",
      columns=(TIME, [each.lower() for each in fortran(ACC)], [each.lower() for each in fortran(FORCE)]))
table("B13", "exponents without a letter, 1.5-103", Refused((":1003:",)), columns=(TIME, ACC, [
    f"{f:.15E}".replace("E", "") if 1000 < n < 1003 else repr(f) for n, f in enumerate(FORCE.tolist())]))
table("B13", "thousands with a blank or a point", Refused(("",)), separator=";", header="time;acc;force", decimal=",",
      columns=(TIME, ACC, [f"{1e6 * f:,.0f}".replace(",", ".") for f in FORCE.tolist()]),
      words=["--map", "time=t [s]", "acc=a_y [m/s^2]", "force=f [uN]"])

# B19. What desktops, editors and file systems leave in an experiment's folder

LEFT_BY_DESKTOPS = (".DS_Store", "._experiment.yaml", ".experiment.yaml.swp", "Thumbs.db", "desktop.ini",
                    "~$notes.xlsx", "notes.txt~", "Icon\r", "lost+found", "@eaDir")
