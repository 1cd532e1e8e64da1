"""The maps of the report: directions as they are seen, positions from above."""
import numpy as np

from evaluation import COLOURS
from evaluation.figures import INK, axis_number, line, numbers, panels, thinned, times, words
from evaluation.files import in_order, only
from evaluation.statistics import with_gaps

TRUTH = '/truth/positions'


def paths(time, columns, names, title, jump):
    """Several paths as one line with gaps: time, each column, and what each point is called."""
    joined, told = [[] for _ in range(1 + len(columns))], []
    everyone = in_order(names)
    for name in everyone:
        one = names == name
        pieces = with_gaps(*thinned(time[one], *(values[one] for values in columns), lines=len(everyone)), gap=np.inf, jump=jump)
        for values, piece in zip(joined, pieces):
            values += list(piece) + [np.nan]
        told += ['%s %s' % (title, words(name))] * (len(pieces[0]) + 1)
    return joined, told


def sky_map(part, reference):
    """Azimuth to the left, elevation upwards."""
    traces = []
    for by, prefix, name, colour, width in (('track', '', 'tracks', COLOURS[0], 1.6), ('target', 'truth_', reference, INK, 1.0)):
        names = np.array(['%g' % number for number in part[by]], dtype=object) if by == 'track' else part[by]
        angles = [np.degrees(part[prefix + angle]) for angle in ('azimuth', 'elevation')]
        (_, azimuth, elevation), told = paths(part['time'], angles, names, by, jump=180.0)
        traces.append(line(numbers(azimuth, 6), numbers(elevation, 6), name, colour, text=told, line={'width': width},
                           hovertemplate='%{text}: %{x:.3f}°, %{y:.3f}°<extra></extra>'))
    layout = dict(panels(['elevation [deg]'], 290), hovermode='closest')
    layout['xaxis'].update(title={'text': 'azimuth [deg], to the left'}, autorange='reversed')
    return {'traces': traces, 'layout': layout, 'note': '', 'still': True}


def metric_map(recording, topic):
    """The scene from above, and heights over time."""
    traces = []
    for kind, name, colour in ((topic, topic, COLOURS[0]), (TRUTH, 'truth', INK)):
        part = only(recording.scene, recording.scene['kind'] == kind)
        if len(part['time']):
            traces += paths_in_metres(part, recording.start, name, colour)
    stations = only(recording.scene, recording.scene['kind'] == 'station')
    for station in sorted(set(stations['name'])):
        traces += station_traces(only(stations, stations['name'] == station), station)
    layout = {'height': 720, 'hovermode': 'closest',
              'xaxis': {'title': {'text': 'x, east [m]'}, 'anchor': 'y'}, 'xaxis2': {'title': {'text': 'time [s]'}, 'anchor': 'y2'},
              'yaxis': {'title': {'text': 'y, north [m]'}, 'domain': [0.36, 1.0], 'scaleanchor': 'x'},
              'yaxis2': {'title': {'text': 'height [m]'}, 'domain': [0.0, 0.24], 'anchor': 'x2'}}
    return {'traces': traces, 'layout': layout, 'note': 'In the axes of the metric frame of %s.' % topic, 'still': True}


def paths_in_metres(part, start, name, colour):
    columns = [part[column] for column in ('x_m', 'y_m', 'z_m')]
    (time, east, north, up), told = paths(part['time'] - start, columns, part['name'], words(name), jump=np.inf)
    above = line(numbers(east, 6), numbers(north, 6), name, colour, text=told, legendgroup=words(name),
                 hovertemplate='%{text}: %{x} m, %{y} m<extra></extra>')
    heights = dict(above, x=times(time), y=numbers(up, 6), xaxis='x2', yaxis='y' + axis_number(1), showlegend=False,
                   hovertemplate='%{text}: %{y} m at %{x} s<extra></extra>')
    return [above, heights]


def station_traces(part, station):
    """Where it is; of one that moves, its path as well."""
    places = np.unique(np.round(np.column_stack([part['x_m'], part['y_m']]), 2), axis=0)
    mark = {'type': 'scatter', 'mode': 'markers+text', 'x': numbers(part['x_m'][:1]), 'y': numbers(part['y_m'][:1]),
            'text': [words(station)], 'textposition': 'top center', 'showlegend': False, 'cliponaxis': False,
            'hovertemplate': '%{text}: %{x} m, %{y} m<extra></extra>', 'marker': {'symbol': 'triangle-up', 'size': 11, 'color': COLOURS[1]}}
    path = line(numbers(part['x_m']), numbers(part['y_m']), station, COLOURS[1], line={'dash': 'dot'})
    return [mark, path] if len(places) > 1 else [mark]
