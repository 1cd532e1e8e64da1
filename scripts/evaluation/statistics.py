"""Windows of time, percentiles and bands, for the pictures and the report of `evaluate`."""
import numpy as np

FEW_TARGETS = 5  # a line each; of more, percentiles over all
MOST_WINDOWS = 300  # into which time is cut for percentiles and means
NORMAL_975 = 1.959963984540054  # quantile of the normal distribution


class Windows:
    """Time cut into windows of one length, at most MOST_WINDOWS, each of several instants."""

    def __init__(self, time, instants=8.0, most=MOST_WINDOWS):
        self.start = float(np.min(time)) if len(time) else 0.0
        span = (float(np.max(time)) - self.start) if len(time) else 0.0
        self.count = int(max(1, min(most, len(np.unique(time)) / instants)))
        self.length = span / self.count if span > 0.0 else 1.0
        self.centres = self.start + (np.arange(self.count) + 0.5) * self.length

    def of(self, time):
        return np.clip(((time - self.start) / self.length).astype(int), 0, self.count - 1)

    def means(self, time, values):
        """NaN in a window without a value."""
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


def anees_band(degrees):
    """The 95 % band of a mean normalised square of so many degrees of freedom, as in the console (Wilson and Hilferty 1931)."""
    variance = 2.0 / (9.0 * np.maximum(degrees, 1.0))
    half_width = NORMAL_975 * np.sqrt(variance)
    return np.maximum(1.0 - variance - half_width, 0.0) ** 3, (1.0 - variance + half_width) ** 3


def text_with_band(average, degrees):
    """With as many digits as the band needs, as in the console."""
    low, high = anees_band(degrees)
    digits = int(np.clip(np.ceil(-np.log10(0.5 * (high - low))), 2, 6))
    return '%.*f [%.*f, %.*f]' % (digits, average, digits, low, digits, high)


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
