"""Reads the CSV files of `evaluate --csv`, for plot_evaluation and report_evaluation."""
import csv
import re

import numpy as np

# Colours that are told apart with any common colour blindness (after Okabe and Ito).
COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7f7f7f', '#8c6d31', '#5e3c99',
           '#1b7837', '#b2182b', '#2166ac']
FEW_TARGETS = 5  # a line each; of more, percentiles over all
MOST_WINDOWS = 300  # into which time is cut for percentiles and means
TEXTS = ('topic', 'name', 'kind', 'key', 'value', 'sensor', 'verdict', 'reason')


def read_columns(path):
    """Columns of a CSV file by name: texts for topic, name and the like, otherwise numbers, NaN where empty."""
    with open(path, newline='', encoding='utf-8', errors='replace') as file:
        rows = list(csv.reader(file))
    header, rows = rows[0], rows[1:]
    columns = {}
    for i, name in enumerate(header):
        values = [row[i] for row in rows]
        if name in TEXTS or (name == 'target' and 'error_x_m' in header):
            columns[name] = np.array(values, dtype=object)
        else:
            columns[name] = np.array([float(value) if value else np.nan for value in values])
    return columns


def only(columns, mask):
    return {name: values[mask] for name, values in columns.items()}


def topics_of(columns):
    """Sightings first, tracks behind them, in the order of the alphabet."""
    topics = sorted(set(columns['topic']))
    is_sightings = {topic: np.all(columns['track'][columns['topic'] == topic] == 0) for topic in topics}
    return sorted(topics, key=lambda topic: (not is_sightings[topic], topic)), is_sightings


def with_gaps(time, *series, gap=1.0, jump=np.pi):
    """The series with NaN where a line must not be drawn: after a pause, and where an angle wraps."""
    order = np.argsort(time, kind='stable')
    time, series = time[order], [values[order] for values in series]
    breaks = np.diff(time) > gap
    for values in series:
        breaks |= np.abs(np.diff(values)) > jump
    places = np.nonzero(breaks)[0] + 1
    return [np.insert(values, places, np.nan) for values in [time] + series]


def unit_for(values):
    """A unit in which the values are readable, and its size in radians."""
    scale = np.nanpercentile(np.abs(values), 95) if np.any(np.isfinite(values)) else 1.0
    for unit, size in (('deg', np.pi / 180.0), ('mrad', 1e-3), ('µrad', 1e-6)):
        if scale >= 0.2 * size:
            return unit, size
    return 'µrad', 1e-6


def file_name(topic):
    return re.sub(r'[^A-Za-z0-9_]+', '_', topic).strip('_') or 'topic'


class Windows:
    """Time cut into windows of one length, at most MOST_WINDOWS, each of several samples."""

    def __init__(self, time, samples=8.0, most=MOST_WINDOWS):
        self.start = float(np.min(time)) if len(time) else 0.0
        span = (float(np.max(time)) - self.start) if len(time) else 0.0
        instants = len(np.unique(time))
        self.count = int(max(1, min(most, instants / samples)))
        self.length = span / self.count if span > 0.0 else 1.0
        self.centres = self.start + (np.arange(self.count) + 0.5) * self.length

    def of(self, time):
        return np.clip(((time - self.start) / self.length).astype(int), 0, self.count - 1)

    def counts(self, time):
        return np.bincount(self.of(time), minlength=self.count)

    def means(self, time, values):
        known = np.isfinite(values)
        window = self.of(time[known])
        with np.errstate(divide='ignore', invalid='ignore'):
            return (np.bincount(window, weights=values[known], minlength=self.count) /
                    np.bincount(window, minlength=self.count))

    def percentiles(self, time, values, shares):
        """One row a share in [0, 1], one column a window; NaN in a window without a value."""
        known = np.isfinite(values)
        values, window = values[known], self.of(time[known])
        values = values[np.lexsort((values, window))]
        count = np.bincount(window, minlength=self.count)
        first = np.cumsum(count) - count
        found = np.full((len(shares), self.count), np.nan)
        some = count > 0
        for row, share in enumerate(shares):
            place = first[some] + share * (count[some] - 1)
            low = np.floor(place).astype(int)
            high = np.minimum(low + 1, first[some] + count[some] - 1)
            found[row, some] = values[low] + (place - low) * (values[high] - values[low])
        return found


def chi_square_quantile(share, degrees):
    """Of the chi-square distribution, by bisection of its series (Abramowitz and Stegun 6.5.29)."""
    if degrees > 200.0:  # Wilson and Hilferty 1931: better than 1e-4 there
        z = {0.025: -1.959964, 0.975: 1.959964}[share]
        return degrees * (1.0 - 2.0 / (9.0 * degrees) + z * np.sqrt(2.0 / (9.0 * degrees))) ** 3
    from math import exp, lgamma, log
    half = 0.5 * degrees

    def below(x):
        term = total = 1.0 / half
        k = half
        while term > 1e-12 * total:
            k += 1.0
            term *= x / k
            total += term
        return total * exp(half * log(x) - x - lgamma(half))

    low, high = 0.0, half + 10.0 * np.sqrt(half) + 20.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if below(middle) < share else (low, middle)
    return low + high


def anees_band(degrees):
    """The 95 % band of a mean normalised squared error of so many degrees of freedom."""
    degrees = max(float(degrees), 1.0)
    return chi_square_quantile(0.025, degrees) / degrees, chi_square_quantile(0.975, degrees) / degrees


def text_with_band(average, degrees):
    """With as many digits as the band needs, as in the console."""
    low, high = anees_band(degrees)
    digits = int(np.clip(np.ceil(-np.log10(0.5 * (high - low))), 2, 6))
    return '%.*f [%.*f, %.*f]' % (digits, average, digits, low, digits, high)
