"""Makes wrong arguments for calls, and random programs of calls with right and wrong arguments.

Errors that the library cannot detect are left out: arrays shorter than their count, and pointers to invalid memory.
"""

from __future__ import annotations

import copy
import random

from script import CALLBACKS, FUNCTIONS, STRUCTS, Argument, Call, array, is_handle, is_of_any_kind, is_release, makes, plain

NAN, INFINITY = float("nan"), float("inf")
REALS = [0.0, -0.0, 1.0, -1.0, 0.5, 1e-45, 1e-30, 1e30, 3.4e38, NAN, INFINITY, -INFINITY]
TEXTS = [b"", b"\xff\xfe", b"x" * 5000, b"Ceiling", b"L(D|S)*E", b"((((", b"C<RD>[LO]", b"plane 1e9 nan 5 5 5\n", b"no/such/place/a.png", b"a.png"]
BITS = {"int32_t": 32, "uint32_t": 32, "uint64_t": 64, "size_t": 64}
#: Counts that no memory can hold: to be refused before anything is read.
ABSURD = [2**63, 2**64 - 1]


def integers(kind: str) -> list[int]:
    bits = BITS.get(kind, 32)
    if kind in ("uint32_t", "uint64_t", "size_t"):
        return [0, 1, 2, 3, 7, 100, 65535, 65536, 65537, 2**31, 2**bits - 1]
    return [-(2**31), -1, 0, 1, 2, 3, 7, 8, 100, 2**31 - 1]


def is_count(name: str) -> bool:
    return name.endswith("count") or name in ("size", "capacity", "vertex_capacity", "triangle_capacity")


def numbers(kind: str, name: str) -> list[Argument]:
    """Extreme values for a number of type `kind` and name `name`."""
    if kind in ("float", "double"):
        return [plain(x) for x in REALS]
    if is_count(name):
        return [plain(n) for n in [0, 1, 2, *ABSURD]]
    if name == "byte_size":
        return [plain(n) for n in [0, 1, 95, 2**64 - 1]]
    if name.endswith("stride"):
        return [plain(n) for n in [0, 1, 3, 11, 13, *ABSURD]]
    return [plain(n) for n in integers(kind)]


def broken_fields(struct: Argument) -> list[Argument]:
    """Variants of a struct, in each of which one member has a wrong value."""
    _, name, fields, base = struct
    out = []

    def with_field(field: str, value: Argument) -> None:
        out.append(["struct", name, {**fields, field: value}, base])

    for member in STRUCTS[name]:
        if member.stars:
            with_field(member.name, ["null"])
            if member.type == "char":
                for text in TEXTS[:3]:
                    with_field(member.name, plain(text))
        elif member.dims:
            count = 1
            for n in member.dims:
                count *= n
            for value in REALS if member.type in ("float", "double") else integers(member.type):
                with_field(member.name, array(member.type, *[value] * count))
        elif member.name == "struct_size":
            for size in (0, 3, 4, 8, 4095, 4096, 4097, 2**32 - 1):
                with_field(member.name, plain(size))
        else:
            for value in numbers(member.type, member.name):
                with_field(member.name, value)
    return out


def broken(field, right: Argument, others: list[Argument]) -> list[Argument]:
    """Wrong arguments that may replace the right one; `others` are handles of other objects."""
    if is_handle(field):
        return [["null"], ["junk", 0], ["junk", 1], *others]
    if makes(field):
        return [["null"]]
    if field.type in CALLBACKS:
        return [["null"], ["callback", {"luxfer_write_fn": "refuse", "luxfer_work_fn": "fail"}.get(field.type, "cancel")]]
    if field.stars:
        if right[0] == "struct":
            return [["null"], *broken_fields(right)]
        if field.type == "char" and right[0] == "bytes":
            return [["null"], *map(plain, TEXTS)]
        if right[0] == "array":
            return [["null"], *(array(right[1], *[x] * len(right[2])) for x in (REALS if right[1] in ("float", "double") else [0, 7, 2**32 - 1]))]
        return [["null"]]
    return numbers(field.type, field.name)


def every_fault(calls: list[Call]) -> list[Call]:
    """The program with all wrong variants of each call inserted before that call, which must still succeed."""
    out: list[Call] = []
    live: dict[str, list[Argument]] = {}
    number = 1_000_000
    for call in calls:
        function, *arguments = call
        fields = FUNCTIONS[function]
        strangers = [things[0] for kind, things in live.items() if things and (not fields or kind != fields[0].type)]
        for i, field in enumerate(fields):
            others = strangers[:2] if is_handle(field) and not is_of_any_kind(field) else []
            for wrong in broken(field, arguments[i], others):
                if wrong == arguments[i] or endless(field, wrong):
                    continue
                variant = copy.deepcopy(arguments)
                variant[i] = wrong
                made = []
                for k, (f, a) in enumerate(zip(fields, variant)):
                    if makes(f) and a[0] == "new":
                        number += 1
                        variant[k] = ["new", number]
                        made.append(number)
                out.append([function, *variant])
                # A wrong call may succeed after all: release its objects, because jobs and contexts would occupy
                # threads.
                out += [["luxfer_release", ["object", n]] for n in made]
        out.append(call)
        for field, argument in zip(fields, arguments):
            if makes(field) and argument[0] == "new":
                live.setdefault(field.type, []).append(["object", argument[1]])
    return out


def endless(field, argument: Argument) -> bool:
    """Whether an argument is a timeout that would make the call wait for ever, or very long."""
    return field.name == "timeout_ms" and argument[0] == "number" and not 0 <= argument[1] <= 10_000


def random_fault(call: Call, pool: dict[str, list[Argument]], rng: random.Random) -> Call:
    """The call with one argument replaced by another object of its kind or by a wrong value."""
    function, *arguments = call
    fields = FUNCTIONS[function]
    if not fields:
        return call
    i = rng.randrange(len(fields))
    field = fields[i]
    if is_handle(field) and rng.random() < 0.8 and pool.get(field.type):
        arguments[i] = rng.choice(pool[field.type])
    elif not makes(field):
        choices = [a for a in broken(field, arguments[i], []) if not endless(field, a)]
        if choices:
            arguments[i] = rng.choice(choices)
    return [function, *arguments]


def random_program(scenarios: dict[str, list[Call]], seed: int) -> list[Call]:
    """Interleaves two random scenarios, then omits, repeats, moves and damages some of the calls."""
    rng = random.Random(seed)
    first, second = (copy.deepcopy(calls) for calls in rng.sample(list(scenarios.values()), 2))
    renumber(second, 10_000)
    calls: list[Call] = []
    while first or second:
        source = first if (rng.random() < 0.5 and first) or not second else second
        calls += source[: (n := rng.randint(1, 6))]
        del source[:n]
    pool: dict[str, list[Argument]] = {}
    out: list[Call] = []
    fresh = 20_000
    for call in calls:
        for field, argument in zip(FUNCTIONS[call[0]], call[1:]):
            if makes(field) and argument[0] == "new":
                pool.setdefault(field.type, []).append(["object", argument[1]])
        dice = rng.random()
        if dice < 0.05:
            continue
        if dice < 0.35 and not (is_release(call[0]) and dice > 0.1):
            spoiled = random_fault(call, pool, rng)
            for k, argument in enumerate(spoiled[1:], 1):
                if argument[0] == "new" and dice > 0.2:
                    fresh += 1
                    spoiled[k] = ["new", fresh]
                    pool[FUNCTIONS[call[0]][k - 1].type].append(["object", fresh])
            out.append(spoiled)
            if dice < 0.15:
                continue
        out.append(call)
        if rng.random() < 0.05 and len(out) > 3:
            out.insert(rng.randrange(2, len(out)), copy.deepcopy(out[rng.randrange(2, len(out))]))
    return out


def renumber(calls: list[Call], offset: int) -> None:
    def walk(argument: Argument) -> None:
        if argument[0] in ("object", "new"):
            argument[1] += offset
        elif argument[0] == "struct":
            for value in argument[2].values():
                walk(value)
        elif argument[0] == "handles":
            for handle in argument[1]:
                walk(handle)

    for call in calls:
        for argument in call[1:]:
            walk(argument)
