"""The page of the report: which plots and tables it has, and in which order."""
import html
import json
import os
import re

import numpy as np

from evaluation.figures import error_figure, gospa_figure, identity_figure, nees_figure, nis_figure, sensor_figure
from evaluation.files import of_topic
from evaluation.maps import metric_map, sky_map
from evaluation.statistics import unit_for
from evaluation.tables import console_tables, difference_tables, settings_table, text, verdict_table

SECTIONS = (('Scene', ('scene',)), ('Errors', ('errors',)), ('Consistency', ('nees', 'nis')), ('GOSPA', ('gospa',)),
            ('Identities', ('identities',)), ('Sensors', ('sensors',)))
TITLES = {'scene': 'Map', 'errors': 'Errors and what was stated', 'nees': 'Normalised estimation error squared (NEES)',
          'nis': 'Normalised innovation squared (NIS)', 'gospa': 'GOSPA and its parts', 'identities': 'Which track was on which target',
          'sensors': 'Health of the sensors'}
ALL_TOPICS = ''  # key of a plot that does not depend on the chosen tracks


def common_unit(tables, topic, columns):
    """(unit, size) in which the values of all recordings are readable."""
    values = [of_topic(table, topic)[column] for table in tables if table for column in columns]
    return unit_for(np.concatenate(values + [[]]))


def units_of(recordings, topic):
    return {'errors': common_unit([recording.errors for recording in recordings], topic, ('error_azimuth', 'error_elevation')),
            'gospa': common_unit([recording.gospa for recording in recordings], topic, ('distance',))}


def direction_figures(recording, topic, units):
    part = of_topic(recording.errors, topic)
    columns = [(name, 'error_' + name, 'sigma_' + name) for name in ('azimuth', 'elevation')[:recording.channels]]
    kinds = [('nees_position', recording.channels, 'position'), ('nees_state', 2 * recording.channels, 'position and rate')]
    figures = {'scene': sky_map(part, 'truth' if recording.has_truth else 'tracks compared with'),
               'errors': error_figure(part, recording.start, columns, units['errors']),
               'nees': nees_figure(part, recording.start, kinds)}
    if recording.has_truth:
        figures['identities'] = identity_figure(recording, part, topic)
    if recording.gospa and topic in set(recording.gospa['topic']):
        figures['gospa'] = gospa_figure(of_topic(recording.gospa, topic), recording.start, units['gospa'])
    return figures


def position_figures(recording, topic):
    part = of_topic(recording.position_errors, topic)
    columns = [(name, 'error_%s_m' % name, 'sigma_%s_m' % name) for name in ('x', 'y', 'z')]
    figures = {'errors': error_figure(part, recording.start, columns, ('m', 1.0)),
               'nees': nees_figure(part, recording.start, [('nees', 3, 'position')]),
               'identities': identity_figure(recording, part, topic)}
    if recording.position_gospa and topic in set(recording.position_gospa['topic']):
        figures['gospa'] = gospa_figure(of_topic(recording.position_gospa, topic), recording.start, ('m', 1.0))
    if recording.scene:
        figures['scene'] = metric_map(recording, topic)
    return figures


def topic_figures(recording, topic, units):
    if topic in recording.position_topics():
        return position_figures(recording, topic)
    return direction_figures(recording, topic, units) if topic in recording.direction_topics() else {}


def topics_of_all(recordings):
    """Positions first, then what is fused."""
    topics = {topic for recording in recordings for topic in recording.position_topics() + recording.direction_topics()}
    return sorted(topics, key=lambda topic: (not topic.startswith('/positions'), not topic.startswith('/fusion'), topic))


def share_ranges(sides):
    """Errors side by side have the same scale."""
    layouts = [side['layout'] for side in sides if side]
    for axis in [name for name in layouts[0] if name.startswith('yaxis')]:
        ranges = [layout[axis]['range'] for layout in layouts if axis in layout]
        for layout in [layout for layout in layouts if axis in layout]:
            layout[axis]['range'] = [min(low for low, _ in ranges), max(high for _, high in ranges)]


def share_times(figures, recordings):
    """All plots over time from the beginning of their recording to its end."""
    for variants in figures.values():
        for sides in variants.values():
            for figure, recording in zip(sides, recordings):
                if figure and not figure.get('still'):
                    figure['layout']['xaxis']['range'] = [0.0, recording.duration]


def all_figures(recordings, topics):
    """Key of the plot, then topic, to what each recording shows there (None: nothing)."""
    figures = {}
    for topic in topics:
        units = units_of(recordings, topic)
        sides = [topic_figures(recording, topic, units) for recording in recordings]
        for key in dict.fromkeys(key for side in sides for key in side):
            figures.setdefault(key, {})[topic] = [side.get(key) for side in sides]
        share_ranges([side.get('errors') for side in sides])
    figures['nis'] = {ALL_TOPICS: [nis_figure(recording) if recording.innovations else None for recording in recordings]}
    figures['sensors'] = {ALL_TOPICS: [sensor_figure(recording) for recording in recordings]}
    share_times(figures, recordings)
    return {key: variants for key, variants in figures.items() if any(any(sides) for sides in variants.values())}


def about(recording):
    compared = ('compared with the truth %s' % recording.settings['truth'] if recording.has_truth else
                'there is no truth: sightings are compared with the tracks of their trackers, and say nothing of errors that both share')
    return '<p class="about">%s: %s. Time 0 is stamp %.3f s.</p>' % (text(recording.settings['recording']), text(compared), recording.start)


def navigation(names, topics):
    links = ''.join('<a href="#%s">%s</a>' % (name, name) for name in names)
    options = ''.join('<option value="%s">%s</option>' % (html.escape(topic, quote=True), text(topic)) for topic in topics)
    return '<nav>%s<label>tracks <select id="topic">%s</select></label></nav>' % (links, options)


def plot(key, sides):
    boxes = ''.join('<div><div class="side">%s</div><figure><div class="plot" data-figure="%s" data-side="%d"></div>'
                    '<figcaption></figcaption></figure></div>' % (side, key, i) for i, side in enumerate(sides))
    return '<h3>%s</h3><div class="plots">%s</div>' % (TITLES[key], boxes)


def each(recordings, sides, show):
    """What `show` makes of each recording, below each other."""
    return ''.join(('<h3>%s: %s</h3>' % (side, text(recording.name())) if side else '') + show(recording)
                   for side, recording in zip(sides, recordings))


def sections_of(recordings, figures):
    """(title, HTML) of each section."""
    sides = ['this', 'other'] if len(recordings) > 1 else ['']
    if len(recordings) > 1:
        yield 'Differences', difference_tables(*recordings)
    for title, keys in SECTIONS:
        plots = ''.join(plot(key, sides) for key in keys if key in figures)
        if title == 'Sensors':
            plots += each(recordings, sides, verdict_table)
        if plots:
            yield title, plots
    yield 'Figures', each(recordings, sides, lambda recording: console_tables(recording.console))
    yield 'Settings', settings_table(recordings)


def body_of(recordings, topics, figures):
    sections = list(sections_of(recordings, figures))
    parts = ['<h1>Evaluation of %s</h1>' % text(' against '.join(recording.name() for recording in recordings))]
    parts += [about(recording) for recording in recordings]
    parts.append(navigation([title for title, _ in sections], topics))
    parts += ['<h2 id="%s">%s</h2>%s' % (title, title, content) for title, content in sections]
    return '\n'.join(parts)


def script_data(figures):
    """As JSON that HTML takes as text, whatever names are in it."""
    data = json.dumps(figures, separators=(',', ':'), allow_nan=False)
    for letter in '<>&':
        data = data.replace(letter, '\\u%04x' % ord(letter))
    return data


def page_of(recordings, plotly):
    """The whole file. `plotly`: its JavaScript."""
    topics = topics_of_all(recordings)
    figures = all_figures(recordings, topics)
    with open(os.path.join(os.path.dirname(__file__), 'page.html'), encoding='utf-8') as file:
        template = file.read()
    parts = {'TITLE': text('Evaluation of ' + recordings[0].name()), 'SIDES': str(len(recordings)), 'DATA': script_data(figures),
             'PLOTLY': plotly.replace('</script', '<\\/script'), 'BODY': body_of(recordings, topics, figures)}
    return re.sub('@(%s)@' % '|'.join(parts), lambda found: parts[found.group(1)], template)
