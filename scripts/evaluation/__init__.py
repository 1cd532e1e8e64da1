"""What plot_evaluation and report_evaluation are made of."""
# Colours that are told apart with any common colour blindness (after Okabe and Ito).
COLOURS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7f7f7f', '#8c6d31', '#5e3c99',
           '#1b7837', '#b2182b', '#2166ac']
