"""Functions with all of Python's syntax, each called as ``step(do)``: ``do`` notes what it gets, and returns it."""

from __future__ import annotations

import textwrap

_BODIES = """
pass
===
return
===
return do(1)
===
"a docstring"
===
"a docstring"
return step.__doc__
===
...
===
x = do(1)
return x
===
x = y = do([])
return x is y
===
x, y = do(1), do(2)
return x - y
===
(x, *y), z = do((1, 2, 3)), do(4)
return x, y, z
===
[x, y] = do([1, 2])
return y
===
x: int = do(3)
return x
===
x: do(1)
return "x" in locals()
===
x: "unknown[" = do(3)
return x
===
x = 1
x += do(2)
x *= do(3)
x -= 1; x //= 2; x **= 2; x %= 7; x <<= 1; x |= 8; x ^= 3; x &= 255; x >>= 1; x /= 2
return x
===
x = [1]
y = x
x += do([2])
return y
===
class Box: pass
box = Box()
box.n = do(1)
box.n += do(2)
return vars(box)
===
x = {}
x[do("a")] = do(1)
x[do("a")] += do(2)
return x
===
x = [0, 1, 2, 3]
x[do(1):do(3)] = do([9])
del x[do(0)]
return x
===
if do(1) < do(2): return "less"
return "more"
===
if do(False): return 1
elif do(0): return 2
elif do([]): return 3
else: return 4
===
x = 3
return 1 < x < do(5), 1 < x > do(5), do(1) < do(0) < do(2), x == 3 != 4, x is x is not None, x in (3,) not in [()]
===
x = 5
if x < do(1) < unbound: return 1
return 2
===
x = 5
if x > do(1) < unbound: return 1
return 2
===
a = 1
return a < (a := do(0)), a
===
a = do(2)
return (a := a + 1) > a, a
===
return do(0) or do(2) or do(3)
===
return do(1) and do(0) and do(3)
===
return not do(1) and do(2) or not (do(0) or do(False))
===
x = do(1) if do(0) else do(2)
return do(x) if x < 3 else None
===
return [do(i) for i in range(3) if do(i) != 1]
===
return {do(i): do(-i) for i in (1, 2)}, {do(i) for i in (3,)}, list(do(i) for i in (4, 5))
===
x = 2
return [x := i for i in range(x)], x
===
x = do(3)
return [i + x for i in range(x) for x in (i,)], x
===
if (n := do(4)) > 3 and (m := n - 1) < n: return n, m
===
while (n := do(next(numbers))) < 3: pass
return n
===
n = 0
while n < do(3):
    n += 1
    if n == 2: continue
    do(("n", n))
else:
    do("else")
return n
===
n = 0
while True:
    n += 1
    if n > 30: break
else:
    do("never")
return n
===
for i in do(range(3)):
    if i == 1: continue
    do(i)
else:
    do("else")
return i
===
for i in range(50):
    if do(i) == 40: break
else:
    return "never"
return i
===
for i in []: pass
return "i" in locals()
===
for a, (b, c) in [(1, (2, 3)), (4, (5, 6))]: do(a + b + c)
===
for a, *b in [(1, 2, 3)]: do(b)
===
class Box: pass
box = Box()
for box.n in (1, 2): do(box.n)
x = [0]
for x[0] in (3, 4): do(x)
return vars(box), x
===
for i in range(2):
    for j in range(2):
        if do(i) == do(j) == 1: break
    else:
        do("inner")
===
global there
there = do(1)
there += do(2)
for there in (5, 6): do(there)
return there
===
global known
return known
===
n = 0
def inner():
    nonlocal n
    n += do(1)
    return n
inner()
return inner(), n
===
n = 1
def inner():
    nonlocal n
    n = do(7)
    return 0
return n < inner(), n
===
def inner(a, /, b=do(1), *c, d=do(2), **e): return a, b, c, d, e
return inner(0), inner(0, 1, 2, d=3, e=4)
===
def outer():
    yield do(1)
    got = yield do(2)
    return got
def around(): return (yield from outer())
running = around()
try:
    next(running); next(running); running.send("sent")
except StopIteration as stop:
    return stop.value
===
double = lambda x, y=do(2): do(x) * y
return double(3)
===
def mark(function):
    do(function.__name__)
    return function
@mark
@(lambda f: do(f))
def inner(): return 1
return inner()
===
class Inner(metaclass=type):
    x = do(1)
    y = x + do(1)
    def method(self): return do(self.x), __class__.__name__
    z = [x for _ in (1,)]
return Inner().method(), Inner.y
===
class A:
    def who(self): return "A"
class B(A):
    def who(self): return super().who() + do("B")
return B().who()
===
return do(f"{do(1)}{do(2)!r:>{do(4)}}{do(3)=}")
===
return "%s" % do(1), "a" "b", b"c", r"\\d", 1_000, 0x1F, 1j, ...
===
print(do(1), do(2), *do([3]), sep=do("-"), **do({"end": ""}))
===
return dict(a=do(1), **do({"b": 2}), **do({"c": 3})), [*do((1,)), *do((2,))], {**do({1: 2}), do(3): do(4)}, {*do([1])}
===
return do((lambda *a, **k: (a, k)))(do(1), *do((2,)), x=do(3))
===
x = [1, 2, 3]
return x[do(-1)], x[do(0):do(2)], x[::do(2)], x[do(1)].real
===
assert do(1), do("no")
return "well"
===
assert do(0), do("said")
===
try:
    do(1)
    raise ValueError(do(2))
except (TypeError, ValueError) as error:
    do(str(error))
    return "error" in locals()
else:
    do("never")
finally:
    do("finally")
===
try:
    x = do(1)
except ValueError:
    x = 2
else:
    return do("else")
finally:
    do("finally")
===
try:
    return do(1)
finally:
    return do(2)
===
for i in range(3):
    try:
        if i == 1: continue
        if i == 2: break
        do(i)
    finally:
        do(("finally", i))
===
try:
    x = unbound
except NameError as error:
    do(error.name)
raise RuntimeError("other") from KeyError("cause")
===
try:
    1 / do(0)
except ZeroDivisionError as error:
    raise KeyError("again")
===
try:
    raise ValueError("a")
except ValueError:
    raise
===
raise
===
raise do(ValueError)
===
raise do(3)
===
raise ValueError from do(None)
===
x = do([1])
return x[do(3)]
===
return do(1).missing
===
x = do(1)
return (
    x
    + do(2)
    + x.nothing
    + do(4)
)
===
return undefined
===
del do
return do
===
x = 1
del x
return x
===
from contextlib import suppress
with suppress(KeyError):
    x = {}[do(1)]
    do("never")
return "x" in locals()
===
from contextlib import contextmanager
@contextmanager
def manager(n):
    do(("enter", n))
    try: yield n
    finally: do(("exit", n))
with manager(do(1)) as a, manager(do(2)) as b:
    do(a + b)
with manager(3): raise OSError("in it")
===
import math as m, os.path
from math import floor
return m.floor(do(1.5)), floor(do(2.5))
===
match do((1, 2)):
    case [x, y] if do(x) > y: return "first"
    case (1, y) if y == do(2): return "second", x, y
    case _: return "none"
===
match do({"kind": "a", "n": 3}):
    case {"kind": "b"}: return 1
    case {"kind": "a", **rest}: return rest
===
match do("x"):
    case "a" | "b": pass
    case str() as text:
        return text
===
match do(5):
    case 1: do(1)
    case 2: do(2)
return "through"
===
match do([1, [2, 3]]):
    case [int(a), [*b]]: return a, b
===
return sorted(locals())
===
x = 1
y = [do(2)]
for i in range(2): z = i
return sorted(locals())
===
before = set(globals())
x = do(1)
return set(globals()) - before
===
import sys
frame = sys._getframe()
return frame.f_code.co_name, frame.f_lineno, frame.f_code.co_firstlineno, frame.f_code.co_varnames
===
import inspect
return inspect.getsource(step).splitlines()[0]
===
import inspect
x = do(1)
return [line for _, line in [(0, inspect.currentframe().f_lineno)]]
===
if do(1) and (
    do(2)
    or do(3)
):
    return "several lines"
===
if do(0): pass
elif do(1): x = 1; y = 2
else: z = 3
return sorted(locals())
===
a = b = 1; c = do(a) < b; return c
===
class Odd:
    def __bool__(self): do("bool"); return True
    def __repr__(self): raise RuntimeError("repr")
    def __lt__(self, other): do("lt"); return Odd()
    def __eq__(self, other): raise RuntimeError("eq")
    __hash__ = None
x = Odd()
if x < x and not x: return 1
return 1 if x else 2
===
class Fuzzy:
    def __getattribute__(self, name): do(("get", name)); return object.__getattribute__(self, name)
    @property
    def __class__(self): do("class"); return int
x = Fuzzy()
y = [x, {1: x}]
return len(y)
===
class Meta(type):
    def __getattribute__(cls, name): do(("meta", name)); return type.__getattribute__(cls, name)
    def __hash__(cls): do("hash"); return 1
    def __eq__(cls, other): do("eq"); return False
class Thing(metaclass=Meta): pass
x = Thing()
del do.log[:]
y = x
return y is x
===
class Listed(list):
    def __iter__(self): do("iter"); return iter(())
    def __len__(self): do("len"); return 0
    def __getitem__(self, i): do("item"); return None
x = Listed([1, 2])
y = x
return type(y) is Listed
===
class Gone:
    def __del__(self): do("gone")
x = Gone()
x = do(1)
do("after")
x = [Gone()]
x = None
do("end")
===
import weakref
class Thing: pass
x = Thing()
seen = weakref.ref(x)
x = None
return seen() is None
===
def down(n): return n if n == 0 else down(n - 1)
return down(do(50))
===
x = do(float("nan"))
return x < 1, x != x, min(x, 1) is x
===
big = 10 ** do(5000)
return big > 1
===
values = do([])
values.append(values)
return len(values)
===
x = do("\\N{SNOWMAN} ünï")
return x if "☃" in x else do("nö") + x.nö
===
it = iter(do([1, 2, 3]))
return next(it) + next(it), list(it)
===
x = y = 0
def set_x(): nonlocal x; x = do(5); return 1
if x < set_x(): return x
===
a = do(2) @ do(3)
===
x = [1, 2, 3]
first, *_ = x
return first if first in x and first not in [] else None
===
try:
    try: 1 / 0
    finally: do("inner")
except ZeroDivisionError: do("outer")
===
return eval("x + 1", {"x": do(2)}), [*map(do, (1, 2))]
===
exec("y = 3"); return locals().get("y", "none")
===
return (yield_ := do(1)) or yield_
"""

BODIES = [body.strip("\n") for body in _BODIES.split("\n===\n")]
SOURCES = ["def step(do):\n" + textwrap.indent(body, "    ") + "\n" for body in BODIES]

IN_PLACES = {
    "a closure": """
def make(do):
    a, b = 1, [2]
    def step(do, c=3, *, d=4):
        nonlocal a
        a += do(b[0])
        return a, b, c, d
    return step
step = make(do)
""",
    "a method with a private name": """
class Robot:
    __speed = 3
    def step(self, do):
        self.__seen = do(self.__speed)
        return sorted(vars(self)), __class__.__name__
step = Robot().step
""",
    "a method that calls super": """
class A:
    def step(self, do): return "A"
class B(A):
    def step(self, do):
        return super().step(do) + do("B")
step = B().step
""",
    "an object that is called": """
class Robot:
    n = 0
    def __call__(self, do):
        self.n += do(1)
        return self.n
step = Robot()
""",
    "a partial function": """
from functools import partial
def inner(a, do, b):
    return do(a), b
step = partial(inner, 1, b=2)
""",
    "a lambda": "step = lambda do: do(1) < do(2) or do(3)\n",
    "a lambda of many lines": "step = (\n    lambda do: do(1) <\n    do(2)\n)\n",
    "a static method": """
class Robot:
    @staticmethod
    def step(do): return do(1) if do(2) else 3
step = Robot.step
""",
    "a class within a function": """
def make():
    n = 5
    class Robot:
        def step(do):
            if do(n) > 3:
                return n
    return Robot.step
step = make()
""",
    "annotations of the future": """
from __future__ import annotations
def step(do: Unknown) -> Nothing:
    x: Unknown = do(1)
    return x, sorted(step.__annotations__)
""",
    "tabs": "def step(do):\n\tif do(1):\n\t\treturn do(2)\n",
    "two of one name": """
def step(do): return do("first")
def step(do): return do("second")
""",
    "a condition around it": """
if True:
    def step(do):
        return do(1) + 1
""",
    "text of other letters": "def step(do):\n    größe = do('ü☃'); return größe == do('ü☃'), größe.fehlt\n",
}
