"""The plots over time of the report, as plotly takes them: dicts of traces, a layout, and a note below."""
import html

import numpy as np

from evaluation import COLOURS
from evaluation.files import in_order, of_topic, only
from evaluation.statistics import FEW_TARGETS, Windows, anees_band

MOST_POINTS = 2400  # of one line
BAND, ERRORS, INK, GREY = 'rgba(86,180,233,0.30)', 'rgba(0,114,178,0.9)', '#222222', '#b0b0b0'
LONGEST_GAP = 2.0  # [s] between reports of one track on a target


def words(name):
    """A name as plotly shows it, which takes a part of HTML."""
    return html.escape(str(name))


def numbers(values, digits=5):
    """For JSON: rounded, None where there is none."""
    return [None if not np.isfinite(value) else float('%.*g' % (digits, value)) for value in values]


def times(values):
    return [None if not np.isfinite(value) else round(float(value), 2) for value in values]


def thinned(*series, lines=1):
    """As few of the values as are drawn; `lines` share the points."""
    step = max(1, int(np.ceil(len(series[0]) * lines / MOST_POINTS)))
    return [values[::step] for values in series]


def axis_number(index):
    """'' of the first axis, as plotly counts them."""
    return str(index + 1) if index else ''


def line(x, y, name, colour, panel=0, **more):
    style = dict({'color': colour, 'width': 1.4}, **more.pop('line', {}))
    trace = {'type': 'scatter', 'mode': 'lines', 'x': x, 'y': y, 'name': words(name), 'line': style,
             'yaxis': 'y' + axis_number(panel)}
    return dict(trace, **more)


def once(trace, panel):
    """One entry in the legend for the same line in every panel."""
    return dict(trace, legendgroup=trace['name'], showlegend=panel == 0)


def band(x, low, high, name, panel=0):
    edge = line(x, low, name, BAND, panel, line={'width': 0}, hoverinfo='skip', legendgroup=name, showlegend=False)
    return [edge, dict(edge, y=high, fill='tonexty', fillcolor=BAND, showlegend=panel == 0)]


def level(y):
    return {'type': 'line', 'xref': 'paper', 'x0': 0, 'x1': 1, 'y0': y, 'y1': y,
            'line': {'color': INK, 'width': 1, 'dash': 'dash'}}


def panels(titles, height):
    """A layout of panels that stand above each other and share their time. `height`: of one [pixels]."""
    gap = 0.05 if len(titles) > 1 else 0.0
    size = (1.0 - gap * (len(titles) - 1)) / len(titles)
    layout = {'height': 90 + height * len(titles),
              'xaxis': {'title': {'text': 'time [s]'}, 'anchor': 'y' + axis_number(len(titles) - 1)}}
    for i, title in enumerate(titles):
        top = 1.0 - i * (size + gap)
        layout['yaxis' + axis_number(i)] = {'title': {'text': title}, 'domain': [max(0.0, top - size), top], 'zerolinecolor': '#999'}
    return layout


def error_figure(part, start, columns, unit):
    """Errors with what was stated. `columns`: (title, error, sigma) of each panel; `unit`: its name and size."""
    unit, size = unit
    windows = Windows(part['time'] - start)
    traces, layout = [], panels(['%s error [%s]' % (title, unit) for title, _, _ in columns], 190)
    for panel, (_, error, sigma) in enumerate(columns):
        values, sigmas = part[error] / size, part[sigma] / size
        traces += error_panel(windows, part['time'] - start, values, sigmas, part['target'], panel)
        layout['yaxis' + axis_number(panel)]['range'] = reach_of(values, sigmas)
    shares = ['%s %.1f %%' % (title, 100 * np.mean(np.abs(part[error]) > 2 * part[sigma])) for title, error, sigma in columns]
    return {'traces': traces, 'layout': layout, 'note': 'Beyond two stated sigmas: %s; 4.6 %% expected.' % ', '.join(shares)}


def reach_of(errors, sigmas):
    """The range in which errors and sigmas are seen, but for the few worst."""
    reach = 1.4 * max(np.nanpercentile(np.abs(errors), 97), np.nanpercentile(2 * sigmas, 80), 1e-9)
    return [-float(reach), float(reach)]


def error_panel(windows, time, error, sigma, targets, panel):
    """Percentiles over targets and time, and a line a target where they are few."""
    x, stated = times(windows.centres), windows.percentiles(time, sigma, [0.5])[0]
    low, middle, high = windows.percentiles(time, error, [0.023, 0.5, 0.977])
    traces = band(x, numbers(-2 * stated), numbers(2 * stated), 'stated, ±2 sigma', panel)
    for values, name in ((low, '2.3 % of errors'), (high, '97.7 % of errors')):
        traces.append(line(x, numbers(values), name, ERRORS, panel, line={'dash': 'dot', 'width': 1.2}))
    names = in_order(targets)
    if len(names) > FEW_TARGETS:
        traces.append(line(x, numbers(middle), 'median of %d targets' % len(names), COLOURS[1], panel))
    else:
        for k, name in enumerate(names):
            one = targets == name
            median = windows.percentiles(time[one], error[one], [0.5])[0]
            traces.append(line(x, numbers(median), 'target %s, median' % name, COLOURS[(k + 1) % len(COLOURS)], panel))
    return traces[:2] + [once(trace, panel) for trace in traces[2:]]


def nees_figure(part, start, kinds):
    """Mean normalised squares in windows. `kinds`: (column, dimension, name) of each line, the first with a band."""
    time = part['time'] - start
    windows = Windows(time)
    x, low_high = times(windows.centres), anees_band(kinds[0][1] * targets_at_once(windows, time, part['target']))
    traces = band(x, *(numbers(limits) for limits in low_high), '95 % band at one instant')
    for i, (column, _, name) in enumerate(kinds):
        if np.any(np.isfinite(part[column])):
            traces.append(line(x, numbers(windows.means(time, part[column])), name, COLOURS[i]))
    layout = dict(panels(['NEES / dimension'], 240), shapes=[level(1.0)])
    layout['yaxis'].update(type='log', exponentformat='power', dtick=1)
    note = ('Mean in windows of %.3g s; 1 is honest. The band (chi-square) is that of the targets at one instant: errors along one '
            'track are not independent, so that the mean of a window moves within it.' % windows.length)
    return {'traces': traces, 'layout': layout, 'note': note}


def targets_at_once(windows, time, targets):
    """How many targets each window has."""
    names, which = np.unique(targets.astype(str), return_inverse=True)
    seen = np.unique(windows.of(time) * len(names) + which)  # a window and a target, once each
    return np.bincount(seen // len(names), minlength=windows.count)


def nis_figure(recording):
    """Normalised innovations of every tracker; the band is of the sightings of a window."""
    table = recording.innovations
    every, window = np.unique(table['time'], return_inverse=True)
    accepted = np.array([np.median(table['accepted'][window == k]) for k in range(len(every))])
    traces = band(times(every - recording.start), *(numbers(limits) for limits in anees_band(2 * accepted)), '95 % band')
    for i, topic in enumerate(sorted(set(table['topic']))):
        part = of_topic(table, topic)
        traces.append(line(times(part['time'] - recording.start), numbers(part['nis']), topic, COLOURS[i % len(COLOURS)],
                           customdata=part['accepted'].astype(int).tolist(),
                           hovertemplate='%{y} of %{customdata} sightings', line={'width': 1.1}))
    layout = dict(panels(['NIS / dimension'], 260), shapes=[level(1.0)])
    layout['yaxis']['rangemode'] = 'tozero'
    return {'traces': traces, 'layout': layout,
            'note': 'Accepted sightings of every tracker; 1 is an honest prediction. The band (chi-square) is of the median number of '
                    'sightings in a window.'}


def gospa_figure(part, start, unit):
    time = part['time'] - start
    windows = Windows(time)
    x, (unit, size) = times(windows.centres), unit
    traces = [line(x, numbers(windows.means(time, part[column]) / size), name, colour)
              for column, name, colour in (('distance', 'GOSPA', COLOURS[0]), ('localisation', 'of the pairs', COLOURS[2]),
                                           ('ospa', 'OSPA', COLOURS[5])) if column in part]
    traces += [line(x, numbers(windows.means(time, part[column])), name, colour, panel=1, fill='tozeroy')
               for column, name, colour in (('missed', 'missed targets', COLOURS[1]), ('false', 'false tracks', COLOURS[3]))]
    layout = panels(['GOSPA [%s]' % unit, 'number'], 190)
    for axis in ('yaxis', 'yaxis2'):
        layout[axis]['rangemode'] = 'tozero'
    return {'traces': traces, 'layout': layout, 'note': 'Means in windows of %.3g s.' % windows.length}


def stretches(part):
    """(target, track, first, last) of each time that a target has one track."""
    found = []
    for target in in_order(part['target']):
        one = part['target'] == target
        order = np.argsort(part['time'][one], kind='stable')
        time, track = part['time'][one][order], part['track'][one][order]
        ends = np.nonzero((np.diff(track) != 0) | (np.diff(time) > LONGEST_GAP))[0]
        begins, ends = np.concatenate([[0], ends + 1]), np.concatenate([ends, [len(time) - 1]])
        found += [(target, int(track[a]), time[a], time[b]) for a, b in zip(begins, ends)]
    return found


def tracks_elsewhere(recording, topic, on_target):
    """(lane, track, first, last) of the tracks that were on no target."""
    lives = of_topic(recording.lives, topic) if recording.lives else {'track': [], 'first': [], 'last': []}
    return [('no target', int(track), first, last) for track, first, last in zip(lives['track'], lives['first'], lives['last'])
            if int(track) not in on_target]


def identity_figure(recording, part, topic):
    """Which track was on which target, and tracks that were on none."""
    found = stretches(part)
    on_target = {track for _, track, _, _ in found}
    elsewhere = tracks_elsewhere(recording, topic, on_target)
    targets = list(dict.fromkeys(target for target, _, _, _ in found))
    lanes = [words(target) for target in targets + (['no target'] if elsewhere else [])]
    layout = panels(['target'], int(np.clip(22 * len(lanes), 60, 800)))
    layout['yaxis'].update(type='category', categoryorder='array', categoryarray=lanes[::-1], range=[-0.6, len(lanes) - 0.4])
    layout['hovermode'] = 'closest'
    note = ('A change of colour is a change of identity. %d tracks on %d targets, %d on no target; %d times a target got another track or '
            'got its own back.' % (len(on_target), len(targets), len(elsewhere), len(found) - len(targets)))
    return {'traces': identity_bars(found + elsewhere, recording.start), 'layout': layout, 'note': note}


def identity_bars(found, start):
    """A trace a colour."""
    bars = {}
    for target, track, first, last in found:
        colour = GREY if target == 'no target' else COLOURS[track % len(COLOURS)]
        x, y, about = bars.setdefault(colour, ([], [], []))
        told = 'track %d: %.2f to %.2f s' % (track, first - start, last - start)
        x += times([first - start, last - start]) + [None]
        y += [words(target), words(target), None]
        about += [told, told, '']
    return [line(x, y, '', colour, text=about, hovertemplate='%{y}, %{text}<extra></extra>', line={'width': 9}, showlegend=False)
            for colour, (x, y, about) in bars.items()]


class SensorPanels:
    """A panel a quantity, a colour and one entry in the legend a sensor."""

    def __init__(self, sensors):
        self.colours = {sensor: COLOURS[i % len(COLOURS)] for i, sensor in enumerate(sensors)}
        self.titles, self.traces, self.shown = [], [], set()

    def add(self, title, series):
        """`series`: (sensor, time, values) of each line."""
        self.titles.append(title)
        for sensor, time, values in series:
            self.traces.append(line(times(time), numbers(values), sensor, self.colours[sensor], len(self.titles) - 1,
                                    legendgroup=words(sensor), showlegend=sensor not in self.shown))
            self.shown.add(sensor)


def noise_by_truth(recording, sensors):
    for sensor in sensors:
        part = only(recording.errors, (recording.errors['track'] == 0) & (recording.errors['name'] == sensor))
        time = part['time'] - recording.start
        windows = Windows(time, most=120)
        yield sensor, windows.centres, np.sqrt(windows.means(time, part['nees_position']))


def reported(recording, column, change):
    table = recording.sensors
    for sensor in sorted(set(table['sensor'])):
        one = only(table, (table['sensor'] == sensor) & np.isfinite(table[column]))
        order = np.argsort(one['time'], kind='stable')
        time, values = thinned(one['time'][order] - recording.start, change(one[column][order]))
        yield sensor, time, values


def sensor_figure(recording):
    """What each sensor's noise is over what it states, by the truth and as the fusion found it; its clock."""
    seen = sorted(set(recording.errors['name'][recording.errors['track'] == 0])) if recording.errors and recording.has_truth else []
    told = sorted(set(recording.sensors['sensor'])) if recording.sensors else []
    drawn = SensorPanels(sorted(set(seen) | set(told)))
    if seen:
        drawn.add('error / stated<br>by the truth', noise_by_truth(recording, seen))
    for column, title, change in (('noise_scale', 'noise / stated<br>as found', np.sqrt),
                                  ('slow_scale', 'slow error /<br>stated sigma', np.array), ('clock_behind', 'clock behind [s]', np.array)):
        if told and np.any(np.isfinite(recording.sensors[column])):
            drawn.add(title, reported(recording, column, change))
    if not drawn.traces:
        return None
    return {'traces': drawn.traces, 'layout': panels(drawn.titles, 210), 'note': 'Noise and errors over the stated sigma: 1 is a sensor that is as it states.'}
