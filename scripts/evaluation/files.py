"""Reads what `evaluate` writes of a recording: CSV files, and the tables of the console."""
import csv
import itertools
import os
import sys

import numpy as np

TEXTS = ('topic', 'name', 'kind', 'target', 'key', 'value', 'sensor', 'verdict', 'reason')
ROWS_AT_ONCE = 20000  # converted together, for memory


def read_columns(path):
    """Columns of a CSV file by name: texts for topic, name and the like, otherwise numbers, NaN where empty."""
    with open(path, newline='', encoding='utf-8', errors='replace') as file:
        rows = csv.reader(file)
        header = next(rows)
        parts = {name: [] for name in header}
        for lines in iter(lambda: list(itertools.islice(rows, ROWS_AT_ONCE)), []):
            for name, values in zip(header, zip(*lines)):
                parts[name].append(column_of(name, values))
    return {name: np.concatenate(arrays) if arrays else column_of(name, []) for name, arrays in parts.items()}


def column_of(name, values):
    if name in TEXTS:
        return np.array([sys.intern(value) for value in values], dtype=object)
    return np.array([float(value) if value else np.nan for value in values])


def only(columns, mask):
    return {name: values[mask] for name, values in columns.items()}


def of_topic(columns, topic):
    return only(columns, columns['topic'] == topic)


def in_order(names):
    """Each name once; numbers by size."""
    return sorted(set(names), key=lambda name: (len(name), name) if str(name).isdigit() else (0, name))


def topics_of(columns):
    """Sightings first, tracks behind them, in the order of the alphabet."""
    topics = sorted(set(columns['topic']))
    is_sightings = {topic: np.all(columns['track'][columns['topic'] == topic] == 0) for topic in topics}
    return sorted(topics, key=lambda topic: (not is_sightings[topic], topic)), is_sightings


class Recording:
    """What was written of one recording by `evaluate --html`; a table that is not there is empty."""

    def __init__(self, folder):
        for name in ('errors', 'gospa', 'evaluation', 'position_errors', 'position_gospa', 'positions', 'innovations', 'lives', 'sensors', 'scene',
                     'recorded', 'settings'):
            setattr(self, name, table_in(folder, name))
        self.settings = dict(zip(self.settings['key'], self.settings['value']))
        with open(os.path.join(folder, 'console.txt'), encoding='utf-8', errors='replace') as file:
            self.console = file.read()
        times = [table['time'] for table in (self.errors, self.gospa, self.position_errors, self.innovations) if table]
        self.start = min((float(np.min(time)) for time in times), default=0.0)
        self.duration = max((float(np.max(time)) for time in times), default=0.0) - self.start
        self.has_truth = bool(self.settings['truth'])
        self.channels = 1 if self.settings['channels'] == 'azimuth' else 2

    def name(self):
        return os.path.basename(self.settings['recording'])

    def direction_topics(self):
        """Of tracks; without a truth, of the sightings that are compared with them."""
        if not self.errors:
            return []
        topics, is_sightings = topics_of(self.errors)
        return [topic for topic in topics if not (self.has_truth and is_sightings[topic])]

    def position_topics(self):
        return sorted(set(self.position_errors['topic'])) if self.position_errors else []


def table_in(folder, name):
    path = os.path.join(folder, name + '.csv')
    table = read_columns(path) if os.path.exists(path) else {}
    return table if any(len(values) for values in table.values()) else {}
