#!/usr/bin/env python3
"""Parameters of tracker and fusion that change in flight, as nodes and as nodelets, by dynamic_reconfigure's own client and by dynparam."""
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import xmlrpc.client

import dynamic_reconfigure.client
import rosbag
import rosgraph
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.msg import Config, StrParameter
from dynamic_reconfigure.srv import Reconfigure
from rosgraph_msgs.msg import Log

# Our messages lie in the devel space, which the environment that catkin keeps from before the first build does not name.
for prefix in os.environ.get('CMAKE_PREFIX_PATH', '').split(':'):
    sys.path.append(os.path.join(prefix, 'lib/python3/dist-packages'))
from sightline.msg import AssociationArray, FusionReport, Sighting, SightingArray, Track, TrackArray, TrackletArray

FORMS = ['/node', '/nodelet']
PATIENCE = 60.0  # [s] until a test gives up


class Heard:
    """The messages of a topic, as they come."""

    def __init__(self, topic, kind):
        self.messages = []
        self._subscriber = rospy.Subscriber(topic, kind, self.messages.append)

    def is_connected(self):
        return self._subscriber.get_num_connections() > 0


def eventually(condition):
    """Waits until the condition gives something; returns that, or what it gave last."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.02)
    return condition()


def track_of(number, sensor):
    track = Track(id=number, status=Track.CONFIRMED, azimuth=0.3, elevation=0.1, hits=20, existence=0.999, sources=[sensor])
    track.covariance = [0.0] * 16
    for k in range(4):
        track.covariance[5 * k] = 1e-6
    track.gate.covariance = [1e-6, 0.0, 0.0, 1e-6]
    track.last_sighting = rospy.Time.now()
    return track


class Inputs:
    """A sensor that sees one target, and two trackers that report it, ten times a second."""

    def __init__(self):
        self._sightings = rospy.Publisher('/sightings', SightingArray, queue_size=100)
        self._tracks = {name: rospy.Publisher('/%s/tracks' % name, TrackArray, queue_size=100) for name in 'ab'}
        # Advertised alone: the fusion listens to tracklets while its rule makes use of them.
        self.tracklets = rospy.Publisher('/a/tracklets', TrackletArray, queue_size=100)
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self):
        while not self._ends.wait(0.1):
            scan = SightingArray(sensor='camera')
            scan.header.stamp = rospy.Time.now()
            scan.header.frame_id = 'platform_enu'
            scan.ifov = scan.detection_probability = scan.clutter_density = math.nan
            scan.sightings = [Sighting(azimuth=0.3, elevation=0.1, covariance=[1e-6, 0.0, 0.0, 1e-6], snr=math.nan)]
            self._sightings.publish(scan)
            for name, publisher in self._tracks.items():
                report = TrackArray(tracker=name, tracks=[track_of(1, 'camera of ' + name)])
                report.header = scan.header
                publisher.publish(report)

    def end(self):
        self._ends.set()
        self._thread.join()


class ReconfigureTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node('reconfigure_test')
        cls.inputs = Inputs()
        cls.log = Heard('/rosout', Log)
        cls.diagnostics = Heard('/diagnostics', DiagnosticArray)
        cls.associations = {form: Heard(form + '/associations', AssociationArray) for form in FORMS}
        cls.tracks = {form: Heard(form + '/tracks', TrackArray) for form in FORMS}
        cls.fused = {form: Heard(form + '/fusion/tracks', TrackArray) for form in FORMS}
        cls.reports = {form: Heard(form + '/fusion/report', FusionReport) for form in FORMS}

    @classmethod
    def tearDownClass(cls):
        cls.inputs.end()

    def client(self, node):
        return dynamic_reconfigure.client.Client(node, timeout=PATIENCE)

    def is_logged(self, node, words):
        return eventually(lambda: any(words in line.msg for line in self.log.messages if node[1:] in line.msg))

    def diagnostic(self, node, key):
        for message in reversed(self.diagnostics.messages):
            for status in message.status:
                if status.name.startswith(node[1:]):
                    return {value.key: value.value for value in status.values}.get(key)
        return None

    def confirmed(self, heard):
        """The track of the newest message, when it is confirmed and alone."""
        if not heard.messages or len(heard.messages[-1].tracks) != 1:
            return None
        track = heard.messages[-1].tracks[0]
        return track if track.status == Track.CONFIRMED else None

    def topics_connected_to(self, node):
        try:
            node = xmlrpc.client.ServerProxy(rosgraph.Master('/reconfigure_test').lookupNode(node))
            _, _, connections = node.getBusInfo('/reconfigure_test')
        except (OSError, rosgraph.MasterException):
            return []  # not there yet
        return [connection[4] for connection in connections if connection[5]]

    def test_another_gate_holds_for_the_next_scans_of_the_same_track(self):
        for form in FORMS:
            node = form + '/local_tracker'
            client = self.client(node)
            before = eventually(lambda: self.confirmed(self.tracks[form]))
            self.assertTrue(before, form)
            answer = client.update_configuration({'gate/probability': 0.9})
            self.assertEqual(answer['gate/probability'], 0.9)
            heard = self.associations[form].messages
            self.assertTrue(eventually(lambda: heard[-1].associations and
                                       abs(heard[-1].associations[0].threshold + 2.0 * math.log(0.1)) < 1e-9), form)
            self.assertEqual(self.confirmed(self.tracks[form]).id, before.id)
            self.assertEqual(rospy.get_param(node + '/gate/probability'), 0.9)
            self.assertTrue(eventually(lambda: client.get_configuration(PATIENCE)['gate/probability'] == 0.9))
            self.assertTrue(self.is_logged(node, 'gate/probability changed in flight from 0.9995 to 0.9'))
            self.assertEqual(eventually(lambda: self.diagnostic(node, 'changed in flight: gate/probability')),
                             '0.9 (0.9995 at the start)')
            client.update_configuration({'gate/probability': 0.9995})
            client.close()

    def test_refused_values_leave_those_in_force_and_the_log_says_why(self):
        for form in FORMS:
            node = form + '/local_tracker'
            client = self.client(node)
            before = dict(client.get_configuration(PATIENCE))
            answer = client.update_configuration({'gate/probability': 1.5, 'adapt_gate': False})
            self.assertEqual(answer['gate/probability'], before['gate/probability'])
            self.assertEqual(answer['adapt_gate'], True)
            self.assertTrue(self.is_logged(node, 'expected a number in (0, 1), got 1.5'))
            # A client does not ask for what nobody offers; a program may.
            set_parameters = rospy.ServiceProxy(node + '/set_parameters', Reconfigure)
            answer = set_parameters(Config(strs=[StrParameter('estimator', 'kalman')])).config
            self.assertEqual({entry.name: entry.value for entry in answer.doubles}['gate/probability'], before['gate/probability'])
            self.assertTrue(self.is_logged(node, 'estimator holds from the start of the node'))
            self.assertIn('estimator holds', eventually(lambda: self.diagnostic(node, 'changes refused in flight')) or '')
            self.assertEqual(rospy.get_param(node + '/gate/probability', before['gate/probability']), before['gate/probability'])
            client.close()

    def test_another_rule_makes_the_same_global_track(self):
        for form in FORMS:
            node = form + '/track_fusion'
            client = self.client(node)
            before = eventually(lambda: self.confirmed(self.fused[form]))
            self.assertTrue(before, form)
            self.assertTrue(eventually(lambda: self.inputs.tracklets.get_num_connections() > 0))
            answer = client.update_configuration({'rule': 'covariance_intersection'})
            self.assertEqual(answer['rule'], 'covariance_intersection')
            heard = self.reports[form].messages
            self.assertTrue(eventually(lambda: [track.rule for track in heard[-1].tracks] == ['covariance_intersection']))
            self.assertEqual(self.confirmed(self.fused[form]).id, before.id)
            self.assertEqual(self.fused[form].messages[-1].estimator, 'covariance_intersection')
            self.assertTrue(self.is_logged(node, 'rule changed in flight from best to covariance_intersection'))
            self.assertEqual(client.update_configuration({'rule': 'no such rule'})['rule'], 'covariance_intersection')
            self.assertTrue(self.is_logged(node, 'expected one of best, tracklets'))
            client.close()
        self.assertTrue(eventually(lambda: self.inputs.tracklets.get_num_connections() == 0),
                        'nobody needs tracklets any more')
        for form in FORMS:
            client = self.client(form + '/track_fusion')
            client.update_configuration({'rule': 'best'})
            client.close()
        self.assertTrue(eventually(lambda: self.inputs.tracklets.get_num_connections() > 0))

    def test_descriptions_say_types_limits_and_choices(self):
        client = self.client('/node/track_fusion')
        offered = {entry['name']: entry for entry in client.get_parameter_descriptions(PATIENCE)}
        gate = offered['gate/probability']
        self.assertEqual((gate['type'], gate['min'], gate['max'], gate['default']), ('double', 0.0, 1.0, 0.999))
        self.assertIn('in (0, 1)', gate['description'])
        self.assertEqual(offered['coasting_age']['max'], math.inf)
        choices = [entry['value'] for entry in eval(offered['rule']['edit_method'])['enum']]
        self.assertIn('covariance_intersection', choices)
        self.assertEqual(offered['allow_shared_sensors']['type'], 'bool')
        client.close()

    def test_dynparam_lists_gets_sets_and_loads(self):
        def dynparam(*arguments):
            return subprocess.run(('rosrun', 'dynamic_reconfigure', 'dynparam') + arguments, check=True, timeout=PATIENCE,
                                  stdout=subprocess.PIPE, universal_newlines=True).stdout

        listed = dynparam('list').split()
        for form in FORMS:
            self.assertIn(form + '/local_tracker', listed)
            self.assertIn(form + '/track_fusion', listed)
        node = '/node/local_tracker'
        dynparam('set', node, 'lifecycle/coast_silence', '0.7')
        dynparam('set', node, "{'association': jpda, 'lifecycle/merge_scans': 12}")
        values = yaml.safe_load(dynparam('get', node))
        self.assertEqual(values['lifecycle/coast_silence'], 0.7)
        self.assertEqual(values['association'], 'jpda')
        self.assertEqual(values['lifecycle/merge_scans'], 12)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, 'values.yaml')
            dynparam('dump', node, file)
            dynparam('set', node, 'association', 'nearest')
            dynparam('load', node, file)
        self.assertEqual(yaml.safe_load(dynparam('get', node))['association'], 'jpda')

    def test_a_recording_tells_what_changed_when(self):
        topic = '/nodelet/local_tracker/parameter_updates'
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, 'flight.bag')
            recorder = subprocess.Popen(['roslaunch', 'sightline', 'record.launch', 'file:=' + file])
            try:
                self.assertTrue(eventually(lambda: topic in self.topics_connected_to('/record')))
                client = self.client('/nodelet/local_tracker')
                client.update_configuration({'lifecycle/delete_silence': 3.5})
                time_of_change = rospy.Time.now()
                self.assertTrue(self.is_logged('/nodelet/local_tracker', 'lifecycle/delete_silence changed in flight'))
                self.assertTrue(eventually(lambda: client.get_configuration(PATIENCE)['lifecycle/delete_silence'] == 3.5))
            finally:
                recorder.send_signal(signal.SIGINT)
                recorder.wait(PATIENCE)
            with rosbag.Bag(file) as bag:
                values = [(stamp, {entry.name: entry.value for entry in message.doubles}['lifecycle/delete_silence'])
                          for _, message, stamp in bag.read_messages([topic])]
            self.assertEqual([value for _, value in values], [2.0, 3.5])
            self.assertLess(abs((values[1][0] - time_of_change).to_sec()), 5.0)
            client.update_configuration({'lifecycle/delete_silence': 2.0})
            client.close()


if __name__ == '__main__':
    rostest.rosrun('sightline', 'reconfigure_test', ReconfigureTest)
