"""Rates and times, and their text."""


def rate(result, asked):
    """Work items per second of CPU time, in the best round."""
    return len(range(0, asked, result["stride"])) / min(result["cpu_s"])


def quantity(rate):
    for unit, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if rate >= size:
            return f"{rate / size:.3g} {unit}"
    return f"{rate:.3g}"


def figures(value):
    """Text of a number with three significant digits, without an exponent."""
    text = f"{value:.3g}"
    return f"{float(text):,.0f}" if "e+" in text else text


def time(seconds):
    return f"{figures(1e9 * seconds)} ns" if seconds < 1e-6 else f"{figures(1e6 * seconds)} µs"
