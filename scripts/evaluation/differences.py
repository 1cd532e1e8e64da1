"""The figures of two recordings side by side, with bootstrap intervals of their differences."""
import numpy as np

from evaluation.files import of_topic

BLOCK = 5.0  # seconds that are resampled together: errors along a track are not independent
RESAMPLES = 2000
SEED = 1
FEW_BLOCKS = 10

# Column of evaluation.csv or positions.csv, and its title on the page.
DIRECTION_FIGURES = (('rmse', 'RMSE [rad]'), ('rate_rmse', 'rates [rad/s]'), ('anees_position', 'ANEES pos.'),
                     ('anees_state', 'ANEES state'), ('coverage', 'coverage'), ('breaks', 'breaks'),
                     ('id_switches', 'ID changes'), ('gospa', 'GOSPA, mean [rad]'), ('missed', 'GOSPA, missed'),
                     ('extra', 'GOSPA, false'), ('ospa', 'OSPA [rad]'), ('confirm_median', 'confirmed after [s]'),
                     ('completeness', 'completeness'), ('purity', 'purity'), ('tracks', 'tracks'),
                     ('false_tracks', 'false tracks'))
POSITION_FIGURES = (('rmse_m', 'RMSE [m]'), ('median_m', 'median [m]'), ('p95_m', '95 % [m]'),
                    ('median_velocity_m_s', 'velocity, median [m/s]'), ('anees', 'ANEES'), ('coverage', 'coverage'),
                    ('breaks', 'breaks'), ('id_changes', 'ID changes'), ('tracks', 'tracks'),
                    ('false_tracks', 'false tracks'), ('gospa_m', 'GOSPA [m]'))


class Series:
    """Samples over time whose mean, or the root of it, is a figure of the console."""

    def __init__(self, time, values, takes_root=False):
        known = np.isfinite(values)
        self.time, self.values, self.takes_root = time[known], values[known], takes_root

    def block_sums(self, first, count):
        block = np.clip(((self.time - first) / BLOCK).astype(int), 0, count - 1)
        return np.bincount(block, weights=self.values, minlength=count), np.bincount(block, minlength=count)

    def resampled(self, first, blocks):
        """The figure of each row of `blocks`."""
        sums, counts = self.block_sums(first, blocks.shape[1])
        with np.errstate(divide='ignore', invalid='ignore'):
            means = sums[blocks].sum(1) / counts[blocks].sum(1)
        return np.sqrt(means) if self.takes_root else means


def direction_series(recording, topic):
    errors, gospa = of_topic(recording.errors, topic), recording.gospa
    square = (errors['error_azimuth'] ** 2 + errors['error_elevation'] ** 2) / recording.channels
    series = {'rmse': Series(errors['time'], square, takes_root=True)}
    for column, samples in (('anees_position', 'nees_position'), ('anees_state', 'nees_state')):
        series[column] = Series(errors['time'], errors[samples])
    reports = of_topic(gospa, topic) if gospa else {}
    for column, samples in (('gospa', 'distance'), ('missed', 'missed'), ('extra', 'false'), ('ospa', 'ospa')):
        if reports:
            series[column] = Series(reports['time'], reports[samples])
    return series


def position_series(recording, topic):
    errors = of_topic(recording.position_errors, topic)
    square = sum(errors['error_%s_m' % axis] ** 2 for axis in 'xyz')
    series = {'rmse_m': Series(errors['time'], square, takes_root=True), 'anees': Series(errors['time'], errors['nees'])}
    if recording.position_gospa:
        reports = of_topic(recording.position_gospa, topic)
        series['gospa_m'] = Series(reports['time'], reports['distance'])
    return series


def interval(this, other):
    """(low, high) of 95 % of the difference, number of blocks; the same numbers every time. None without samples."""
    if not len(this.time) or not len(other.time):
        return None
    firsts = [float(np.min(series.time)) for series in (this, other)]
    is_paired = abs(firsts[0] - firsts[1]) < BLOCK  # of one scene: the same seconds are drawn of both
    if is_paired:
        firsts = [min(firsts)] * 2
    counts = [int((np.max(series.time) - first) / BLOCK) + 1 for series, first in zip((this, other), firsts)]
    if is_paired:
        counts = [max(counts)] * 2
    random = np.random.RandomState(SEED)
    blocks = [random.randint(0, counts[0], (RESAMPLES, counts[0]))]
    blocks.append(blocks[0] if is_paired else random.randint(0, counts[1], (RESAMPLES, counts[1])))
    change = this.resampled(firsts[0], blocks[0]) - other.resampled(firsts[1], blocks[1])
    if not np.any(np.isfinite(change)):
        return None
    return tuple(np.nanpercentile(change, [2.5, 97.5])) + (min(counts),)


def rows_of(table, topic):
    """The figures of a topic, by column; empty where it is not in the table, or in it twice."""
    if not table or np.count_nonzero(table['topic'] == topic) != 1:
        return {}
    return {name: values[0] for name, values in of_topic(table, topic).items()}


def figures_of(recording):
    """(topic, title, column) to (value, series or None), in the order of the page; values as the console prints them."""
    found = {}
    overall = recording.evaluation
    if overall:
        overall = {name: values[overall['kind'] != 'target'] for name, values in overall.items()}
    for topics, table, columns, series_of in (
            (recording.position_topics(), recording.positions, POSITION_FIGURES, position_series),
            (recording.direction_topics(), overall, DIRECTION_FIGURES, direction_series)):
        for topic in topics:
            row, series = rows_of(table, topic), series_of(recording, topic)
            for column, title in columns:
                if np.isfinite(row.get(column, np.nan)):
                    found[topic, title] = (row[column], series.get(column))
    return found


def differences(this, other):
    """Rows (topic, title, this, other, interval or None) of the figures that both recordings have."""
    mine, theirs = figures_of(this), figures_of(other)
    rows = []
    for key in [key for key in mine if key in theirs]:
        (value, series), (other_value, other_series) = mine[key], theirs[key]
        rows.append(key + (value, other_value, interval(series, other_series) if series and other_series else None))
    return rows
