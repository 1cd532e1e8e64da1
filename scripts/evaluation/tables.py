"""The tables of the report: those of the console as they are, and those of two recordings side by side."""
import html
import re

import numpy as np

from evaluation.differences import BLOCK, FEW_BLOCKS, RESAMPLES, SEED, differences

PARAMETERS = ('Of what `replay` tracked, /replay/parameters has the parameters that it was given, and all others had their defaults. Of '
              'what was tracked live, /NODE/parameters has all numbers, switches and words, where they were recorded.')


def text(value):
    return html.escape(str(value))


def table(header, rows, kinds=()):
    """Cells are text, not HTML. `kinds`: the class of each row, '' = none."""
    def line(cells, tag, kind=''):
        kind = ' class="%s"' % kind if kind else ''
        return '<tr%s>%s</tr>' % (kind, ''.join('<%s>%s</%s>' % (tag, text(cell), tag) for cell in cells))
    kinds = list(kinds) or [''] * len(rows)
    body = ''.join(line(row, 'td', kind) for row, kind in zip(rows, kinds))
    return '<div class="wide"><table><thead>%s</thead><tbody>%s</tbody></table></div>' % (line(header, 'th'), body)


def cells_of(line):
    """Of an aligned table: cells stand at least two spaces apart, and a deep indent is an empty first cell."""
    return ([''] if line.startswith('   ') else []) + re.split(r'\s{2,}', line.strip())


def block_of(lines):
    """One table of the console, and the lines below it; what is no table is kept as it stands."""
    header, rows, kinds = cells_of(lines[0]), [], []
    for line, following in zip(lines[1:], lines[2:] + ['']):
        cells = cells_of(line)
        if len(cells) == len(header) + 1 and not rows:  # a column without a title
            header.insert(1, '')
        if len(cells) == len(header):
            rows.append(cells)
            kinds.append('')
        elif len(cells) == 1 and following.startswith('  '):  # a heading over its rows
            rows.append(cells + [''] * (len(header) - 1))
            kinds.append('group')
        else:
            break
    is_table = len(header) > 1 and rows
    rest = lines[1 + len(rows):] if is_table else lines
    return (table(header, rows, kinds) if is_table else '') + ('<pre>%s</pre>' % text('\n'.join(rest)) if rest else '')


def console_tables(console):
    """With the console's words and digits."""
    return ''.join(block_of(block.split('\n')) for block in re.split(r'\n\s*\n', console.strip('\n')))


def difference_line(title, value, other_value, found):
    """(cells, whether the interval excludes zero)."""
    low, high = found[:2] if found else (0.0, 0.0)
    return ([title] + ['%.4g' % number for number in (value, other_value, value - other_value)] +
            ['[%.3g, %.3g]' % (low, high) if found else '-'], low > 0.0 or high < 0.0)


def topic_differences(topic, rows, is_open):
    """A table that folds."""
    lines = [difference_line(*row) for row in rows]
    content = table(['figure', 'this', 'other', 'difference', '95 % interval'], [cells for cells, _ in lines],
                    ['differs' if differs else '' for _, differs in lines])
    told = ', '.join(cells[0] for cells, differs in lines if differs)
    return '<details%s><summary>%s: %s</summary>%s</details>' % (
        ' open' if is_open else '', text(topic), text('differ in ' + told if told else 'no difference beyond the intervals'), content)


def difference_tables(this, other):
    found = differences(this, other)
    if not found:
        return '<p>No topic of tracks was compared in both recordings.</p>'
    topics = list(dict.fromkeys(row[0] for row in found))
    parts = [topic_differences(topic, [row[1:] for row in found if row[0] == topic], topic == topics[0]) for topic in topics]
    note = ('Difference: this minus other. Interval: bootstrap over blocks of %g s, %d draws of seed %d, the same seconds of both where '
            'the recordings are of one time. Rows in colour: the interval excludes zero.' % (BLOCK, RESAMPLES, SEED))
    fewest = min((row[-1][2] for row in found if row[-1]), default=FEW_BLOCKS)
    if fewest < FEW_BLOCKS:
        note += ' With so few blocks (%d) the intervals are too narrow: record longer.' % fewest
    return ''.join(parts) + '<p class="note">%s</p>' % note


def settings_of(recording):
    """(where, key) to value: how it was evaluated, and what it tells of its settings."""
    found = {('evaluation', key): value for key, value in recording.settings.items()}
    if recording.recorded:
        columns = (recording.recorded[name] for name in ('topic', 'key', 'value'))
        found.update({(topic, key): value for topic, key, value in zip(*columns)})
    return found


def settings_table(recordings):
    told = [settings_of(recording) for recording in recordings]
    rows, kinds = [], []
    for key in dict.fromkeys(key for side in told for key in side):
        values = [side.get(key, '-') or '-' for side in told]
        rows.append(list(key) + values)
        kinds.append('differs' if len(set(values)) > 1 else '')
    sides = ['this', 'other'] if len(recordings) > 1 else ['value']
    note = ('Rows in colour differ. ' if len(recordings) > 1 else '') + PARAMETERS
    return table(['', ''] + sides, rows, kinds) + '<p class="note">%s</p>' % note


def verdict_table(recording):
    """What fusion and trackers said of the sensors: every verdict once, with its first time and the reason then."""
    sensors, first = recording.sensors, {}
    if not sensors:
        return '<p class="note">This recording has no report on its sensors.</p>'
    for sensor, verdict, reason, time in zip(*(sensors[name] for name in ('sensor', 'verdict', 'reason', 'time'))):
        if verdict and time < first.get((sensor, verdict), (np.inf, ''))[0]:
            first[sensor, verdict] = (time, reason)
    rows = sorted((sensor, time, verdict, reason) for (sensor, verdict), (time, reason) in first.items())
    cells = [(sensor, '%.1f' % (time - recording.start), verdict, reason) for sensor, time, verdict, reason in rows]
    return table(['sensor', 'first at [s]', 'verdict', 'reason then'], cells) if cells else ''
