"""The figures of report_evaluation, as plotly takes them, from the files that `evaluate --html` writes."""
import html
import os

import numpy as np

from evaluation_files import (COLOURS, FEW_TARGETS, Windows, anees_band, only, read_columns, topics_of, unit_for, with_gaps)

MOST_POINTS = 2400  # of one line, or of the paths of one map
BAND, ERRORS, INK = 'rgba(86,180,233,0.30)', 'rgba(0,114,178,0.9)', '#222222'


class Recording:
    """What was written about one recording; a table that is not there is empty."""

    def __init__(self, folder):
        self.folder = folder
        for name in ('errors', 'gospa', 'position_errors', 'innovations', 'lives', 'sensors', 'scene', 'recorded', 'settings'):
            path = os.path.join(folder, name + '.csv')
            table = read_columns(path) if os.path.exists(path) else {}
            setattr(self, name, table if table and len(next(iter(table.values()))) else {})
        self.settings = dict(zip(self.settings.get('key', []), self.settings.get('value', [])))
        with open(os.path.join(folder, 'console.txt'), encoding='utf-8', errors='replace') as file:
            self.console = file.read()
        times = [table['time'] for table in (self.errors, self.position_errors, self.innovations) if table]
        self.start = float(min(np.min(time) for time in times)) if times else 0.0
        self.has_truth = bool(self.settings.get('truth'))

    def name(self):
        return os.path.basename(self.settings.get('recording', self.folder))

    def direction_topics(self):
        if not self.errors:
            return []
        topics, is_sightings = topics_of(self.errors)
        return [topic for topic in topics if not is_sightings[topic]] if self.has_truth else topics

    def position_topics(self):
        return sorted(set(self.position_errors['topic'])) if self.position_errors else []


def words(text):
    """A name as plotly shows it, which takes a part of HTML."""
    return html.escape(str(text))


def plain(number):
    return '%g' % number if isinstance(number, float) else str(number)


def numbers(values, digits=5):
    """For JSON: rounded, None where there is none."""
    return [None if not np.isfinite(value) else float('%.*g' % (digits, value)) for value in values]


def times(values):
    return [None if not np.isfinite(value) else round(float(value), 2) for value in values]


def thinned(*series, lines=1):
    """As few of the values as are drawn; `lines` share the points."""
    step = max(1, int(np.ceil(len(series[0]) * lines / MOST_POINTS)))
    return [values[::step] for values in series]


def line(x, y, name, colour, **more):
    trace = {'type': 'scatter', 'mode': 'lines', 'x': x, 'y': y, 'name': words(name), 'line': {'color': colour, 'width': 1.4}}
    trace['line'].update(more.pop('line', {}))
    trace.update(more)
    return trace


def band(x, low, high, name, colour, axis='', group=None, shown=True):
    edge = {'type': 'scatter', 'mode': 'lines', 'x': x, 'line': {'width': 0, 'color': colour}, 'hoverinfo': 'skip',
            'xaxis': 'x', 'yaxis': 'y' + axis, 'legendgroup': group or name}
    return [dict(edge, y=low, showlegend=False), dict(edge, y=high, fill='tonexty', fillcolor=colour, name=words(name), showlegend=shown)]


def panels(titles, x_title, height=190, share=True, log=()):
    """A layout of panels that stand above each other and share their time."""
    count, gap = len(titles), 0.05 if len(titles) > 1 else 0.0
    size = (1.0 - gap * (count - 1)) / count
    layout = {'height': 90 + height * count, 'xaxis': {'title': {'text': x_title}, 'anchor': 'y' + (str(count) if count > 1 else '')}}
    for i, title in enumerate(titles):
        top = 1.0 - i * (size + gap)
        axis = {'title': {'text': title}, 'domain': [max(0.0, top - size), top], 'zerolinecolor': '#999'}
        if i in log:
            axis.update(type='log', exponentformat='power', dtick=1)
        layout['yaxis' + (str(i + 1) if i else '')] = axis
    return layout


def error_figure(part, start, columns, unit, size):
    """Errors with what was stated: percentiles over targets and time, a line a target where they are few."""
    time = part['time'] - start
    windows, traces = Windows(time), []
    x = times(windows.centres)
    layout = panels(['%s error [%s]' % (title, unit) for title, _, _ in columns], 'time [s]')
    targets = sorted(set(part['target']))
    for i, (_, error, sigma) in enumerate(columns):
        axis, first = (str(i + 1) if i else ''), i == 0
        error, stated = part[error] / size, windows.percentiles(time, part[sigma] / size, [0.5])[0]
        low, middle, high = windows.percentiles(time, error, [0.023, 0.5, 0.977])
        traces += band(x, numbers(-2 * stated), numbers(2 * stated), 'stated, ±2 sigma', BAND, axis, shown=first)
        for values, name, dash in ((low, '2.3 % of errors', 'dot'), (high, '97.7 % of errors', 'dot')):
            traces.append(line(x, numbers(values), name, ERRORS, yaxis='y' + axis, legendgroup=name, showlegend=first,
                               line={'dash': dash, 'width': 1.2}))
        if len(targets) <= FEW_TARGETS:
            for k, target in enumerate(targets):
                one = part['target'] == target
                values = windows.percentiles(time[one], error[one], [0.5])[0]
                name = 'target %s, median' % plain(target)
                traces.append(line(x, numbers(values), name, COLOURS[(k + 1) % len(COLOURS)], yaxis='y' + axis, legendgroup=name,
                                   showlegend=first))
        else:
            traces.append(line(x, numbers(middle), 'median of %d targets' % len(targets), COLOURS[1], yaxis='y' + axis,
                               legendgroup='median', showlegend=first))
        reach = 1.4 * max(np.nanpercentile(np.abs(error), 97), np.nanpercentile(2 * stated, 90), 1e-9)
        layout['yaxis' + axis]['range'] = [-reach, reach]
    outside = [100 * np.mean(np.abs(part[error]) > 2 * part[sigma]) for _, error, sigma in columns]
    note = 'Beyond two stated sigmas: %s; 4.6 %% expected.' % ', '.join(
        '%s %.1f %%' % (title, share) for (title, _, _), share in zip(columns, outside))
    return {'traces': traces, 'layout': layout, 'note': note}


def nees_figure(part, start, kinds):
    """Mean normalised squared errors in windows with the band of as many targets at one instant."""
    time = part['time'] - start
    windows, traces = Windows(time), []
    x = times(windows.centres)
    names, which = np.unique(part['target'], return_inverse=True)
    seen = np.unique(windows.of(time) * len(names) + which)  # a window and a target, once each
    targets = np.bincount(seen // len(names), minlength=windows.count)
    limits = [anees_band(kinds[0][1] * max(1, count)) for count in range(int(targets.max()) + 1)]
    traces += band(x, numbers([limits[n][0] for n in targets]), numbers([limits[n][1] for n in targets]),
                   '95 % band at one instant', BAND)
    for i, (column, _, name) in enumerate(kinds):
        if np.any(np.isfinite(part[column])):
            traces.append(line(x, numbers(windows.means(time, part[column])), name, COLOURS[i]))
    layout = panels(['NEES / dimension'], 'time [s]', 240, log=(0,))
    layout['shapes'] = [level(1.0)]
    note = ('Mean in windows of %.3g s; 1 is honest. The band (chi-square) is that of the targets at one instant: errors along one '
            'track are not independent, so that the mean of a window moves within it.' % windows.length)
    return {'traces': traces, 'layout': layout, 'note': note}


def level(y):
    return {'type': 'line', 'xref': 'paper', 'x0': 0, 'x1': 1, 'y0': y, 'y1': y, 'line': {'color': INK, 'width': 1, 'dash': 'dash'}}


def nis_figure(recording):
    """Normalised innovations of every tracker; the band is of the sightings of a window."""
    table, traces = recording.innovations, []
    topics = sorted(set(table['topic']))
    all_times = sorted(set(table['time']))
    count = np.array([np.median(table['accepted'][table['time'] == time]) for time in all_times])
    limits = [anees_band(2 * max(1.0, n)) for n in count]
    traces += band(times(np.array(all_times) - recording.start), numbers([low for low, _ in limits]),
                   numbers([high for _, high in limits]), '95 % band', BAND)
    for i, topic in enumerate(topics):
        part = only(table, table['topic'] == topic)
        order = np.argsort(part['time'])
        traces.append(line(times(part['time'][order] - recording.start), numbers(part['nis'][order]), topic, COLOURS[i % len(COLOURS)],
                           customdata=part['accepted'][order].astype(int).tolist(),
                           hovertemplate='%{y} of %{customdata} sightings', line={'width': 1.1}))
    layout = panels(['NIS / dimension'], 'time [s]', 260)
    layout['yaxis']['rangemode'] = 'tozero'
    layout['shapes'] = [level(1.0)]
    return {'traces': traces, 'layout': layout,
            'note': 'Accepted sightings of every tracker; 1 is an honest prediction. The band (chi-square) is of the median number of '
                    'sightings in a window.'}


def gospa_figure(part, start):
    time = part['time'] - start
    windows = Windows(time)
    x, traces = times(windows.centres), []
    unit, size = unit_for(part['distance'])
    layout = panels(['GOSPA [%s]' % unit, 'number'], 'time [s]', 190)
    for column, name, colour in (('distance', 'GOSPA', COLOURS[0]), ('localisation', 'of the pairs', COLOURS[2]),
                                 ('ospa', 'OSPA', COLOURS[5])):
        traces.append(line(x, numbers(windows.means(time, part[column]) / size), name, colour))
    for column, name, colour in (('missed', 'missed targets', COLOURS[1]), ('false', 'false tracks', COLOURS[3])):
        traces.append(line(x, numbers(windows.means(time, part[column])), name, colour, yaxis='y2', fill='tozeroy'))
    for axis in ('yaxis', 'yaxis2'):
        layout[axis]['rangemode'] = 'tozero'
    return {'traces': traces, 'layout': layout, 'note': 'Means in windows of %.3g s.' % windows.length}


def stretches(part, gap):
    """(target, track, first, last) of each time that a target has one track."""
    found = []
    for target in sorted(set(part['target'])):
        one = part['target'] == target
        order = np.argsort(part['time'][one], kind='stable')
        time, track = part['time'][one][order], part['track'][one][order]
        ends = np.nonzero((np.diff(track) != 0) | (np.diff(time) > gap))[0]
        begins = np.concatenate([[0], ends + 1])
        ends = np.concatenate([ends, [len(time) - 1]])
        found += [(plain(target), int(track[a]), time[a], time[b]) for a, b in zip(begins, ends)]
    return found


def identity_figure(recording, part, topic):
    """Which track was on which target, and tracks that were on none."""
    start = recording.start
    found = stretches(part, 2.0)
    on_target = {track for _, track, _, _ in found}
    nowhere = []
    if recording.lives:
        lives = only(recording.lives, recording.lives['topic'] == topic)
        nowhere = [('no target', int(track), first, last) for track, first, last in zip(lives['track'], lives['first'], lives['last'])
                   if int(track) not in on_target]
    bars = {}
    for target, track, first, last in found + nowhere:
        colour = COLOURS[track % len(COLOURS)] if target != 'no target' else '#b0b0b0'
        x, y, text = bars.setdefault(colour, ([], [], []))
        label, about = words(target), 'track %d: %.2f to %.2f s' % (track, first - start, last - start)
        x += times([first - start, last - start]) + [None]
        y += [label, label, None]
        text += [about, about, '']
    traces = [{'type': 'scatter', 'mode': 'lines', 'x': x, 'y': y, 'text': text, 'hovertemplate': '%{text}<extra></extra>',
               'line': {'width': 9, 'color': colour}, 'showlegend': False} for colour, (x, y, text) in bars.items()]
    lanes = list(dict.fromkeys([words(target) for target, _, _, _ in found + nowhere]))
    layout = panels(['target'], 'time [s]', int(np.clip(40 + 22 * len(lanes), 120, 900)))
    layout['yaxis'].update(type='category', categoryorder='array', categoryarray=lanes[::-1])
    layout['hovermode'] = 'closest'
    changes = len(found) - len({target for target, _, _, _ in found})
    return {'traces': traces, 'layout': layout,
            'note': 'A change of colour is a change of identity. %d tracks on %d targets, %d on no target; %d times a target got another '
                    'track or got its own back.' % (len(on_target), len({t for t, _, _, _ in found}), len(nowhere), max(0, changes))}


def sky_figure(part, reference):
    """The scene as it is seen: azimuth to the left, elevation upwards."""
    traces = []
    for by, columns, name, colour, width in (('track', ('azimuth', 'elevation'), 'tracks', COLOURS[0], 1.6),
                                             ('target', ('truth_azimuth', 'truth_elevation'), reference, INK, 1.0)):
        x, y, text = [], [], []
        paths = sorted(set(part[by]))
        for number in paths:
            one = part[by] == number
            _, azimuth, elevation = with_gaps(*thinned(part['time'][one], *(np.degrees(part[c][one]) for c in columns), lines=len(paths)),
                                              gap=np.inf, jump=180.0)
            x += numbers(azimuth, 6) + [None]
            y += numbers(elevation, 6) + [None]
            text += ['%s %s' % (by, plain(number))] * (len(azimuth) + 1)
        traces.append(line(x, y, name, colour, text=text, hovertemplate='%{text}: %{x:.3f}°, %{y:.3f}°', line={'width': width}))
    layout = panels(['elevation [deg]'], 'azimuth [deg], to the left', 380)
    layout['xaxis']['autorange'] = 'reversed'
    layout['hovermode'] = 'closest'
    return {'traces': traces, 'layout': layout, 'note': '', 'still': True}


def metric_figure(recording, topic):
    """The scene from above, and heights over time."""
    scene, traces = recording.scene, []
    kinds = [kind for kind in ('/truth/positions', topic) if kind in set(scene['kind'])]
    for kind in kinds:
        colour, name = (INK, 'truth') if kind == '/truth/positions' and kind != topic else (COLOURS[0], topic)
        part = only(scene, scene['kind'] == kind)
        x, y, z, time, text = [], [], [], [], []
        paths = sorted(set(part['name']))
        for track in paths:
            one = part['name'] == track
            t, east, north, up = with_gaps(*thinned(part['time'][one] - recording.start, *(part[c][one] for c in ('x_m', 'y_m', 'z_m')),
                                                    lines=len(paths)), gap=np.inf, jump=np.inf)
            x, y, z, time = x + numbers(east, 6) + [None], y + numbers(north, 6) + [None], z + numbers(up, 6) + [None], time + times(t) + [None]
            text += ['%s %s' % (name, track)] * (len(t) + 1)
        text = [words(each) for each in text]
        traces.append(line(x, y, name, colour, text=text, hovertemplate='%{text}: %{x} m, %{y} m', legendgroup=name))
        traces.append(line(time, z, name, colour, text=text, hovertemplate='%{text}: %{y} m', xaxis='x2', yaxis='y2', legendgroup=name,
                           showlegend=False))
    stations = only(scene, scene['kind'] == 'station')
    for station in sorted(set(stations['name'])):
        one = stations['name'] == station
        places = np.unique(np.round(np.column_stack([stations['x_m'][one], stations['y_m'][one]]), 2), axis=0)
        traces.append({'type': 'scatter', 'mode': 'markers+text', 'x': numbers(places[:1, 0]), 'y': numbers(places[:1, 1]),
                       'text': [words(station)], 'textposition': 'top center', 'showlegend': False, 'cliponaxis': False,
                       'hovertemplate': '%{text}: %{x} m, %{y} m<extra></extra>', 'marker': {'symbol': 'triangle-up', 'size': 11, 'color': COLOURS[1]}})
        if len(places) > 1:
            traces.append(line(numbers(stations['x_m'][one]), numbers(stations['y_m'][one]), station, COLOURS[1], line={'dash': 'dot'}))
    layout = {'height': 720, 'hovermode': 'closest',
              'xaxis': {'title': {'text': 'x, east [m]'}, 'anchor': 'y'}, 'xaxis2': {'title': {'text': 'time [s]'}, 'anchor': 'y2'},
              'yaxis': {'title': {'text': 'y, north [m]'}, 'domain': [0.36, 1.0], 'scaleanchor': 'x'},
              'yaxis2': {'title': {'text': 'height [m]'}, 'domain': [0.0, 0.24], 'anchor': 'x2'}}
    return {'traces': traces, 'layout': layout, 'note': 'In the axes of the metric frame of %s.' % topic, 'still': True}


def sensor_figure(recording):
    """What each sensor's noise is over what it states: by the truth, and as the fusion found it."""
    traces, titles, log = [], [], ()
    if recording.errors and recording.has_truth:
        sightings = only(recording.errors, recording.errors['track'] == 0)
        for i, sensor in enumerate(sorted(set(sightings['name']))):
            part = only(sightings, sightings['name'] == sensor)
            windows = Windows(part['time'] - recording.start, most=120)
            ratio = np.sqrt(windows.means(part['time'] - recording.start, part['nees_position']))
            traces.append(line(times(windows.centres), numbers(ratio), sensor, COLOURS[i % len(COLOURS)], legendgroup=words(sensor)))
        if traces:
            titles.append('error / stated sigma, by the truth')
    shown = set(trace['legendgroup'] for trace in traces)
    table = recording.sensors
    for column, title, change in (('noise_scale', 'noise / stated sigma, as found', np.sqrt), ('slow_scale', 'slow error / stated sigma', np.array),
                                  ('clock_behind', 'clock behind [s]', np.array)):
        if not table or not np.any(np.isfinite(table[column])):
            continue
        titles.append(title)
        for i, sensor in enumerate(sorted(set(table['sensor']))):
            one = (table['sensor'] == sensor) & np.isfinite(table[column])
            order = np.argsort(table['time'][one], kind='stable')
            time, values = thinned(table['time'][one][order] - recording.start, change(table[column][one][order]))
            group = words(sensor)
            traces.append(line(times(time), numbers(values), sensor, COLOURS[i % len(COLOURS)], legendgroup=group, showlegend=group not in shown,
                               yaxis='y' + (str(len(titles)) if len(titles) > 1 else '')))
            shown.add(group)
    if not traces:
        return None
    return {'traces': traces, 'layout': panels(titles, 'time [s]', 210), 'note': '1 is a sensor that is as it states.'}
