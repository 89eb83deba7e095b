"""The model of tests/bench/ranks/model.py says what must be so of any such model: one rank is what was measured, a link without limits leaves
what is divided and what is not, and more of anything that costs costs more.

    ranks_model_test.py
"""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench", "ranks"))
import model

EWA = {"method": "ewa", "width": 1280, "height": 720, "samples": 20_000_000, "filled": 0.6,
       "stages": [["select", 1.0], ["nearest", 100.0], ["sum", 200.0], ["resolve", 10.0], ["phong", 5.0], ["encode", 3.0]]}
POINT = {**EWA, "method": "point", "stages": [["nearest", 100.0], ["resolve", 1.0], ["encode", 3.0]]}
NO_LIMIT = {"rate": 1e30, "latency": 0.0, "copy_rate": 1e30}


class Model(unittest.TestCase):
    def test_one_rank_takes_what_was_measured(self):
        for passes in (EWA, POINT):
            self.assertEqual(model.total(passes, 1, 1e9, 1e-3), sum(ms for _, ms in passes["stages"]))

    def test_without_limits_what_is_left_is_the_fullest_share_and_what_one_does_alone(self):
        for ranks in (2, 4, 64):
            found = model.picture(EWA, ranks, **NO_LIMIT)
            self.assertAlmostEqual(found["share"], 300 / ranks * model.fullest(round(20_000_000 / model.NODE_SAMPLES), ranks))
            self.assertAlmostEqual(found["screen"], 15 / ranks)
            self.assertEqual(found["alone"], 4)
            self.assertAlmostEqual(found["copy"] + found["agree"], 0)

    def test_the_keys_of_720p_on_four_ranks(self):
        """By hand, at the worst: every rank has something in every pixel, and sends three quarters of 7.37 MB to whose rows they are; three
        quarters of the finished pixels go to rank 0. With each a bit for 16 pixels, in whole words: 16 bytes a row. 8 ms are what 10 Gbit/s may take."""
        dense = {**POINT, "filled": 1.0}
        found = model.picture(dense, 4, 10 * model.GBIT, 0, overlap=1e6)["agree"]
        pixels, marks = 1280 * 720, 720 * 16
        self.assertAlmostEqual(found, 1000 * 0.75 * ((pixels * 8 + marks) + (pixels * 4 + marks)) / 1.25e9, places=6)
        self.assertLess(model.picture(dense, 4, 10 * model.GBIT, 20e-6, overlap=1e6)["agree"], 8)

    def test_more_of_what_costs_costs_more(self):
        for passes in (EWA, POINT):
            times = [model.total(passes, 8, link * model.GBIT, 20e-6) for link in (10, 25, 100)]
            self.assertEqual(times, sorted(times, reverse=True))
            self.assertLess(model.total({**passes, "filled": 0.1}, 8, 1e9, 0), model.total(passes, 8, 1e9, 0))
            self.assertLess(model.total(passes, 4, **NO_LIMIT), model.total(passes, 4, **NO_LIMIT, slower=2))
        self.assertLess(model.total(POINT, 16, 1e9, 0), model.total(EWA, 16, 1e9, 0))

    def test_shares_are_about_even_where_there_are_nodes_enough(self):
        for ranks in (1, 2, 3, 64):
            owners = [model.owner(node, ranks) for node in range(20_000)]
            self.assertEqual(set(owners), set(range(ranks)))
            self.assertLess(model.fullest(20_000, ranks), 1 + 6 * (ranks / 20_000) ** 0.5 + 1e-9)
        self.assertGreater(model.fullest(128, 64), 1.5, "few nodes are not shared evenly")

    def test_n_times_the_samples_take_each_rank_as_long(self):
        one, many = model.total(POINT, 1, **NO_LIMIT), model.total(POINT, 64, **NO_LIMIT, weak=True)
        self.assertLess(many / one, 1.05)


if __name__ == "__main__":
    unittest.main()
